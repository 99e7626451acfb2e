// SPDX-License-Identifier: BSD-3-Clause
/// Bodies over wide trees that move from frame to frame, and pairs of them asked in every frame:
/// AllPairs' sibling. Balls around the bodies dismiss what is far apart; what is near takes turns,
/// two pairs at a time. Or some pairs of them, which come and go: what a World asks.
///
/// What is remembered from one frame to the next is a policy: nothing (Forgetful), so that every
/// pair starts from the roots, or how long answers stay (WideMargins).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <ranges>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"
#include "traversal/all_pairs.hpp"
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

 public:
  /// One body for each shape, which must outlive this.
  explicit WidePairs(std::span<const WideShape<V, F>> shapes, std::vector<ObjectPair> pairs = {})
      : pairs_(std::move(pairs)), workers_(1) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) {
      bodies_.emplace_back(*shape.mesh, *shape.hierarchy);
      meshes_.push_back(shape.mesh);
      balls_.push_back(shape.hierarchy->ball());
    }
    centres_.resize(bodies_.size()), reaches_.resize(bodies_.size());
    near_.resize(pairs_.size());
    if constexpr (Memory::remembers) {
      for (const auto& shape : shapes)
        memory_.add_body(shape.hierarchy->ball(), shape.hierarchy->reach());
      memory_.resize(pairs_.size());
    }
  }

  /// As AllPairs::frame; answers are taken in the order of pairs that were far apart, then of those
  /// that were not, as they come.
  template <class Counter, class Ask, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, Ask&& ask, Take&& take) {
    using Query = std::remove_cvref_t<decltype(ask(0))>;
    if (!placed_) origin_ = middle_of(poses), placed_ = true;
    if constexpr (Memory::remembers) return frame_from_memory<Query>(poses, counter, ask, take);
    for (std::size_t i = 0; i < bodies_.size(); ++i) place_with_ball(i, poses[i]);
    std::size_t near = pairs_.size();
    const std::uint64_t before = counter.n_v + counter.n_p;
    if constexpr (!SeeksDistance<Query>) {
      near = find_near(counter);
      for (std::size_t k = near; k < pairs_.size(); ++k) {
        counter.asked(before);
        take(near_[k], ask(near_[k]));
      }
    } else {
      for (std::size_t k = 0; k < near; ++k) near_[k] = static_cast<std::uint32_t>(k);
    }
    take_turns<Query>(std::span(near_).first(near), workers_[0], before, counter, ask, take);
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
    if constexpr (Memory::remembers)
      place(bodies_[i], poses_[i], origin_), memory_.move(i, poses_[i]);
    else
      place_with_ball(i, poses_[i]);
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

  /// What a thread needs for itself, in cache lines of its own.
  struct alignas(128) Worker {
    std::array<WideWorkspace, at_once> workspaces;
    std::vector<std::uint32_t> near;  ///< pairs
  };

  void place_with_ball(std::size_t i, const Pose& pose) {
    place(bodies_[i], pose, origin_);
    centres_[i] = pose(balls_[i].centre);
    // What is off, of a corner and of the centre, and of how far they are apart.
    reaches_[i] = (balls_[i].radius + 4 * bodies_[i].orthonormal_pose().noise) *
                  (1 + 16 * unit_roundoff<double>);
  }
  bool balls_meet(const ObjectPair& pair) const {
    const auto [i, j] = pair;
    const double reach = reaches_[i] + reaches_[j];
    return !((centres_[i] - centres_[j]).squaredNorm() > reach * reach);
  }

  /// Puts the pairs whose balls meet before the others; says how many they are.
  template <class Counter>
  std::size_t find_near(Counter& counter) {
    std::size_t near = 0, far = pairs_.size();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      const bool meet = balls_meet(pairs_[p]);
      near_[near] = static_cast<std::uint32_t>(p);
      near += meet;
      far -= !meet;
      if (!meet) near_[far] = static_cast<std::uint32_t>(p);
    }
    counter.tested(pairs_.size());
    return near;
  }

  /// Bodies are placed when one of their pairs has to be looked at.
  template <class Query, class Counter, class Ask, class Take>
  void frame_from_memory(std::span<const Pose> poses, Counter& counter, Ask& ask, Take& take) {
    poses_ = poses;
    memory_.template begin_frame<Query>();
    for (std::size_t i = 0; i < bodies_.size(); ++i) memory_.move(i, poses[i]);
    ask_near<Query>(std::views::iota(std::uint32_t{0}, static_cast<std::uint32_t>(pairs_.size())),
                    workers_[0], counter, ask, take);
  }

  /// Asks these pairs: those at once that are known not to have changed, or are far apart.
  template <class Query, class Slots, class Counter, class Ask, class Take>
  void ask_near(const Slots& slots, Worker& worker, Counter& counter, Ask& ask, Take& take) {
    std::vector<std::uint32_t>& near = worker.near;
    if (near.size() < slots.size()) near.resize(slots.size());
    std::size_t due = 0;
    for (const std::uint32_t p : slots) {
      if constexpr (Memory::remembers)
        if (memory_.template stays<Query>(p, pairs_[p])) {
          auto query = ask(p);
          memory_.repeat(p, query);
          take(p, query);
          continue;
        }
      near[due++] = p;
    }
    const std::uint64_t before = counter.n_v + counter.n_p;
    counter.tested(due);
    std::size_t left = 0;
    for (std::size_t k = 0; k < due; ++k) {
      const std::uint32_t p = near[k];
      if constexpr (!SeeksDistance<Query>)
        if (is_apart(p)) {
          counter.asked(before);
          take(p, ask(p));
          continue;
        }
      near[left++] = p;
    }
    take_turns<Query>(std::span(near).first(left), worker, before, counter, ask, take);
  }
  bool is_apart(std::uint32_t p) {
    if constexpr (Memory::remembers)
      return memory_.stays_after_all(p, pairs_[p]) || memory_.balls_apart(p, pairs_[p]);
    else
      return !balls_meet(pairs_[p]);
  }

  /// `before`: what had been tested when the frame began.
  template <class Query, class Counter, class Ask, class Take>
  void take_turns(std::span<const std::uint32_t> near, Worker& worker, std::uint64_t before,
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
      pair[slot] = near[next++];
      const auto [i, j] = pairs_[pair[slot]];
      if constexpr (Memory::remembers)
        place(bodies_[i], poses_[i], origin_), place(bodies_[j], poses_[j], origin_);
      if constexpr (Measure::measures)
        running[slot]->begin(bodies_[i], bodies_[j], ask(pair[slot]), counter,
                             memory_.template touched<Query>(pair[slot]), memory_.front(pair[slot]),
                             memory_.displacement(pairs_[pair[slot]]));
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
  std::vector<Body> bodies_;
  std::vector<const TriangleMesh*> meshes_;
  std::vector<MeshBall> balls_;
  std::vector<Vec3<double>> centres_;
  std::vector<double> reaches_;
  std::vector<std::uint32_t> near_;  // pairs, near ones first
  std::vector<Worker> workers_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  [[no_unique_address]] Memory memory_;
  std::span<const Pose> poses_;
  std::vector<std::uint32_t> moved_;  // in slots: who moved last
  bool placed_ = false;
};

}  // namespace bvlab
