// SPDX-License-Identifier: BSD-3-Clause
/// Bodies over wide trees that move from frame to frame, and pairs of them asked in every frame:
/// AllPairs' sibling. Balls around the bodies, and directions in which they do not reach each
/// other, dismiss pairs by the registerful; what is left takes turns, two at a time. Or some pairs
/// of them, which come and go: what a World asks.
///
/// What is remembered from one frame to the next is a policy: nothing (Forgetful), so that every
/// pair starts from the roots, or how long answers stay (WideMargins).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <ranges>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/primitives/triangle_margin.hpp"
#include "traversal/wide/separating_direction.hpp"
#include "traversal/wide/wide_margins.hpp"

namespace bvlab {

/// A mesh and the wide hierarchy over it.
template <BoundingVolume V, int F>
struct WideShape {
  const TriangleMesh* mesh;
  const WideHierarchy<V, F>* hierarchy;
};

template <BoundingVolume V, int F, class Frame = RelativeFrame, class Memory = Forgetful>
class WidePairs {
  using Body = typename Frame::template Body<V, F>;
  using Indices = SeparatingDirections::Indices;
  static constexpr std::size_t width = SeparatingDirections::width;

 public:
  /// One body for each shape, which must outlive this; threads are for `frame`.
  explicit WidePairs(std::span<const WideShape<V, F>> shapes, std::vector<ObjectPair> pairs = {},
                     int threads = 1)
      : pairs_(std::move(pairs)), threads_(threads), workers_(threads_.count()) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) {
      bodies_.emplace_back(*shape.mesh, *shape.hierarchy);
      meshes_.push_back(shape.mesh);
      balls_.push_back(shape.hierarchy->ball());
    }
    add_support_maps();
    if constexpr (Memory::remembers) {
      for (const auto& shape : shapes)
        memory_.add_body(shape.hierarchy->ball(), shape.hierarchy->reach());
      memory_.resize(pairs_.size());
    }
  }

  /// As AllPairs::frame; with one thread, answers are taken in the order of pairs that were far
  /// apart, then of those that were not, as they come.
  template <class Counter, class Ask, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, Ask&& ask, Take&& take) {
    using Query = std::remove_cvref_t<decltype(ask(0))>;
    if (!placed_) origin_ = middle_of(poses), placed_ = true;
    poses_ = poses;
    if constexpr (Memory::remembers) memory_.template begin_frame<Query>();
    if constexpr (std::is_same_v<Frame, RelativeFrame>)
      if (threads_.count() > 1) return frame_on_threads<Query>(counter, ask, take);
    for (std::size_t i = 0; i < bodies_.size(); ++i) follow(i);
    ask_near<Query>(std::views::iota(std::uint32_t{0}, static_cast<std::uint32_t>(pairs_.size())),
                    workers_[0], counter, ask, take);
  }

  // ---- some pairs of them, in slots: see world_of.hpp -----------------------------------------

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return *meshes_[i]; }

  void put(std::uint32_t slot, const ObjectPair& pair) {
    if (slot >= pairs_.size()) {
      pairs_.resize(slot + 1);
      if constexpr (Memory::remembers) memory_.resize(slot + 1);
    }
    pairs_[slot] = pair;
  }
  void drop(std::uint32_t slot) {
    if constexpr (Memory::remembers) memory_.forget(slot);
  }

  /// A frame in which these have moved; `poses`, of all, must stay until it has been asked.
  template <class Query>
  void begin(std::span<const std::uint32_t> movers, std::span<const Pose> poses,
             const Vec3<double>&, Threads& threads) {
    static_assert(std::is_same_v<Frame, RelativeFrame>, "else threads pose the same nodes");
    poses_ = poses;
    if (workers_.size() < threads.count()) workers_.resize(threads.count());
    if constexpr (Memory::remembers) {
      memory_.template begin_frame<Query>();
      for (const auto i : moved_) memory_.rest(i);
      moved_.assign(movers.begin(), movers.end());
    }
  }
  /// Puts one of them where it stands.
  void stand(std::uint32_t i) {
    follow(i);
    if constexpr (Memory::remembers) place(bodies_[i], poses_[i], origin_);
  }

  /// As `worker`, below the number of threads: `ask(slot, pair)`, `take(slot, pair, query)`.
  template <class Counter, class Ask, class Take>
  void ask(std::span<const std::uint32_t> slots, std::size_t worker, Counter& counter, Ask&& ask,
           Take&& take) {
    using Query = std::remove_cvref_t<decltype(ask(0, pairs_[0]))>;
    const auto make = [&](std::size_t p) { return ask(static_cast<std::uint32_t>(p), pairs_[p]); };
    const auto give = [&](std::size_t p, const Query& query) {
      take(static_cast<std::uint32_t>(p), pairs_[p], query);
    };
    ask_near<Query>(slots, workers_[worker], counter, make, give);
  }

  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  /// No front is kept.
  std::size_t front_size() const { return 0; }
  std::size_t front_size(std::uint32_t) const { return 0; }

 private:
  static constexpr std::size_t at_once = 2;

  static constexpr int most_directions = 2;

  /// What a thread needs for itself, in cache lines of its own.
  struct alignas(128) Worker {
    std::array<WideWorkspace, at_once> workspaces;
    std::vector<std::int32_t> near, far;  ///< pairs; with room for a register behind them
    std::size_t near_count = 0, far_count = 0;

    void make_room(std::size_t pairs) {
      if (near.size() < pairs + width) near.resize(pairs + width), far.resize(pairs + width);
      near_count = far_count = 0;
    }
    void put(std::int32_t pair, std::size_t is_near) {
      near[near_count] = far[far_count] = pair;
      near_count += is_near, far_count += 1 - is_near;
    }
    /// The first `used` of these.
    void put(const Indices& pairs, std::size_t used, std::uint64_t is_near) {
      alignas(64) std::array<std::int32_t, width> pair;
      pairs.copy_to(pair.data(), stdx::vector_aligned);
      for (std::size_t k = 0; k < used; ++k) put(pair[k], is_near >> k & 1);
    }
  };

  /// One for each mesh.
  void add_support_maps() {
    directions_.resize(bodies_.size());
    std::map<const SupportMap*, std::int32_t> added;
    for (const Body& body : bodies_) {
      const SupportMap& map = body.hierarchy().supports();
      if (!added.contains(&map)) added[&map] = directions_.add(map);
      maps_.push_back(added[&map]);
    }
  }

  /// Puts a body where it stands, as far as is needed to see which of its pairs to look at.
  void follow(std::size_t i) {
    if constexpr (Memory::remembers) {
      if (memory_.move(i, poses_[i])) memory_.stand(i, directions_, maps_[i], origin_);
    } else {
      place(bodies_[i], poses_[i], origin_);
      directions_.stand(i, maps_[i], poses_[i].rotation, poses_[i](balls_[i].centre) - origin_,
                        balls_[i].radius, bodies_[i].orthonormal_pose().noise);
    }
  }

  template <class Query, class Counter, class Ask, class Take>
  void frame_on_threads(Counter& counter, Ask& ask, Take& take) {
    threads_.share_out(bodies_.size(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t i = begin; i < end; ++i) stand(static_cast<std::uint32_t>(i));
    });
    answers_.ask<Query>(
        threads_, pairs_.size(), pairs_.size(), counter, [](std::size_t p) { return p; },
        [&](std::size_t begin, std::size_t end, std::size_t worker, Counter& own, auto&& answer) {
          ask_near<Query>(
              std::views::iota(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)),
              workers_[worker], own, ask, answer);
        },
        take);
  }

  /// Asks these pairs: those at once that are known not to have changed, or are far apart.
  template <class Query, class Slots, class Counter, class Ask, class Take>
  void ask_near(const Slots& slots, Worker& worker, Counter& counter, Ask& ask, Take& take) {
    worker.make_room(slots.size());
    for (const std::uint32_t p : slots) {
      if constexpr (Memory::remembers)
        if (memory_.template stays<Query>(p, pairs_[p])) {
          auto query = ask(p);
          memory_.repeat(p, query);
          take(p, query);
          continue;
        }
      worker.near[worker.near_count++] = static_cast<std::int32_t>(p);
    }
    const std::uint64_t before = counter.n_v + counter.n_p;
    counter.tested(worker.near_count);
    if constexpr (!SeeksDistance<Query>) {
      if constexpr (Memory::remembers) {
        tell_what_stays(worker);
        if constexpr (Query::one_hit_is_enough) tell_by_crossings(worker, counter);
      } else {
        tell_by_balls(worker);
      }
      tell_by_directions(worker, counter);
      for (std::size_t k = 0; k < worker.far_count; ++k) {
        const auto p = static_cast<std::size_t>(worker.far[k]);
        counter.asked(before);
        auto query = ask(p);
        if constexpr (Memory::remembers) memory_.repeat(p, query);
        take(p, query);
      }
    }
    take_turns<Query>(std::span(worker.near).first(worker.near_count), worker, before, counter, ask,
                      take);
  }

  void tell_by_balls(Worker& worker) const {
    const std::size_t count = std::exchange(worker.near_count, 0);
    for (std::size_t k = 0; k < count; k += width) {
      const Indices numbers(&worker.near[k], stdx::element_aligned);
      const std::size_t used = std::min(width, count - k);
      worker.put(numbers, used, directions_.balls_meet(pairs_of(numbers, used)));
    }
  }
  void tell_what_stays(Worker& worker) {
    const std::size_t count = std::exchange(worker.near_count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      const std::int32_t p = worker.near[k];
      worker.put(p, !memory_.stays_after_all(static_cast<std::size_t>(p),
                                             pairs_[static_cast<std::size_t>(p)]));
    }
  }
  /// By the triangles that crossed last time.
  template <class Counter>
  void tell_by_crossings(Worker& worker, Counter& counter) {
    constexpr std::size_t at_a_time = 8;
    std::array<std::array<Triangle, at_a_time>, 2> triangles;
    std::array<std::array<const Triangle*, at_a_time>, 2> pointers;
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t k = 0; k < at_a_time; ++k) pointers[side][k] = &triangles[side][k];
    std::array<std::int32_t, at_a_time> waiting;
    std::array<double, at_a_time> margins;
    std::size_t used = 0;
    const auto ask = [&] {
      crossing_margins<>(pointers[0].data(), pointers[1].data(), static_cast<int>(used),
                         margins.data());
      counter.primitives(used);
      for (std::size_t k = 0; k < used; ++k) {
        const auto p = static_cast<std::size_t>(waiting[k]);
        if (margins[k] > 0)
          memory_.goes_on_crossing(p, pairs_[p], margins[k]);
        else
          memory_.stops_crossing(p);
        worker.put(waiting[k], !(margins[k] > 0));
      }
      used = 0;
    };
    // What is put back among those near is behind the one that is read.
    const std::size_t count = std::exchange(worker.near_count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      const auto p = static_cast<std::size_t>(worker.near[k]);
      const auto& crossing = memory_.crossing(p);
      if (!crossing) {
        worker.near[worker.near_count++] = worker.near[k];
        continue;
      }
      const std::array<std::uint32_t, 2> body{pairs_[p].i, pairs_[p].j},
          triangle{crossing->a, crossing->b};
      for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t i = 0; i < 3; ++i)
          triangles[side][used][i] =
              poses_[body[side]](meshes_[body[side]]->corners(triangle[side])[i]);
      waiting[used++] = worker.near[k];
      if (used == at_a_time) ask();
    }
    if (used > 0) ask();
  }
  /// All but those of which more is known.
  template <class Counter>
  void tell_by_directions(Worker& worker, Counter& counter) {
    std::size_t known = 0;
    if constexpr (Memory::remembers)
      for (std::size_t k = 0; k < worker.near_count; ++k) {
        const auto p = static_cast<std::size_t>(worker.near[k]);
        if (memory_.has_front(p) || memory_.goes_on(p))
          std::swap(worker.near[k], worker.near[known++]);
      }
    const std::size_t count = std::exchange(worker.near_count, known);
    counter.tested(count - known);
    for (std::size_t k = known; k < count; k += width) {
      const Indices numbers(&worker.near[k], stdx::element_aligned);
      const std::size_t used = std::min(width, count - k);
      const auto pairs = pairs_of(numbers, used);
      auto direction = SeparatingDirections::normalized(pairs.between);
      const auto gaps = directions_.gaps(pairs, direction, most_directions);
      const std::uint64_t near = ~bits(gaps > 0.0f);
      if constexpr (Memory::remembers)
        for (std::size_t lane = 0; lane < used; ++lane)
          if (!(near >> lane & 1)) {
            const auto p = static_cast<std::size_t>(worker.near[k + lane]);
            memory_.apart(p, pairs_[p], gaps[lane]);
          }
      worker.put(numbers, used, near);
    }
  }
  /// The first `used` of these pairs.
  SeparatingDirections::Pairs pairs_of(const Indices& numbers, std::size_t used) const {
    Indices place = 2 * numbers;
    const Indices lanes([](auto lane) { return static_cast<std::int32_t>(lane); });
    stdx::where(lanes >= static_cast<std::int32_t>(used), place) = 0;
    const auto body = [&](const std::uint32_t& first) {
      return std::bit_cast<Indices>(
          gathered<static_cast<int>(width)>(reinterpret_cast<const float*>(&first), place));
    };
    return directions_.pairs(body(pairs_[0].i), body(pairs_[0].j));
  }

  /// `before`: what had been tested when the frame began.
  template <class Query, class Counter, class Ask, class Take>
  void take_turns(std::span<const std::int32_t> near, Worker& worker, std::uint64_t before,
                  Counter& counter, Ask& ask, Take& take) {
    using Measure = std::conditional_t<SeeksDistance<Query>, NotMeasuring,
                                       typename Memory::template Measure<F>>;
    using Traversal = WideTraversal<V, F, Frame, Query, Counter, Measure>;
    std::array<Traversal, at_once> traversals{Traversal(worker.workspaces[0]),
                                              Traversal(worker.workspaces[1])};
    std::array<std::uint32_t, at_once> pair;
    std::size_t next = 0, active = 0;
    std::array<Traversal*, at_once> running;
    const auto begin = [&](std::size_t slot) {
      pair[slot] = static_cast<std::uint32_t>(near[next++]);
      const auto [i, j] = pairs_[pair[slot]];
      if constexpr (Memory::remembers)
        place(bodies_[i], poses_[i], origin_), place(bodies_[j], poses_[j], origin_);
      if constexpr (Measure::measures)
        running[slot]->begin(bodies_[i], bodies_[j], ask(pair[slot]), counter,
                             memory_.template touched<Query>(pair[slot]), memory_.front(pair[slot]),
                             memory_.turn(pairs_[pair[slot]]));
      else
        running[slot]->begin(bodies_[i], bodies_[j], ask(pair[slot]), counter);
    };
    for (; active < at_once && next < near.size(); ++active) {
      running[active] = &traversals[active];
      begin(active);
    }
    while (active > 0)
      for (std::size_t slot = 0; slot < active;) {
        if (running[slot]->advance()) {
          ++slot;
          continue;
        }
        counter.asked(before);
        if constexpr (Memory::remembers)
          memory_.remember(pair[slot], pairs_[pair[slot]], running[slot]->query(),
                           running[slot]->measure());
        take(pair[slot], running[slot]->query());
        if (next < near.size()) {
          begin(slot++);
        } else {
          --active;
          std::swap(running[slot], running[active]), std::swap(pair[slot], pair[active]);
        }
      }
  }

  std::vector<ObjectPair> pairs_;
  Threads threads_;
  AnswersInOrder answers_;
  std::vector<Body> bodies_;
  std::vector<const TriangleMesh*> meshes_;
  std::vector<MeshBall> balls_;
  SeparatingDirections directions_;
  std::vector<std::int32_t> maps_;  // by which directions_ knows a body's mesh
  std::vector<Worker> workers_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  [[no_unique_address]] Memory memory_;
  std::span<const Pose> poses_;
  std::vector<std::uint32_t> moved_;  // in slots: who moved last
  bool placed_ = false;
};

}  // namespace bvlab
