// SPDX-License-Identifier: BSD-3-Clause
/// Bodies over wide trees that move from frame to frame, and pairs of them asked in every frame:
/// AllPairs' sibling. Balls around the bodies, and directions in which they do not reach each
/// other, dismiss pairs by the registerful; what is left takes turns, two pairs at a time.
///
/// What is remembered from one frame to the next is a policy: nothing (Forgetful), so that every
/// pair starts from the roots, or how long answers stay (WideMargins).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "traversal/all_pairs.hpp"
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
  /// One body for each shape, which must outlive this.
  WidePairs(std::span<const WideShape<V, F>> shapes, std::vector<ObjectPair> pairs)
      : pairs_(std::move(pairs)) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) {
      bodies_.emplace_back(*shape.mesh, *shape.hierarchy);
      balls_.push_back(shape.hierarchy->ball());
    }
    directions_.resize(bodies_.size());
    add_maps();
    near_.resize(pairs_.size() + width), far_.resize(pairs_.size() + 1);
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
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      place(bodies_[i], poses[i], origin_);
      directions_.stand(i, maps_[i], poses[i].rotation, poses[i](balls_[i].centre) - origin_,
                        balls_[i].radius, bodies_[i].orthonormal_pose().noise);
    }
    before_ = counter.n_v + counter.n_p;
    if constexpr (!SeeksDistance<Query>) {
      find_near(counter);
      for (std::size_t k = 0; k < far_count_; ++k) {
        const auto p = static_cast<std::size_t>(far_[k]);
        counter.asked(before_);
        take(p, ask(p));
      }
    } else {
      near_count_ = pairs_.size();
      for (std::size_t k = 0; k < near_count_; ++k) near_[k] = static_cast<std::int32_t>(k);
    }
    take_turns<Query>(counter, ask, take);
  }

  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  /// No front is kept.
  std::size_t front_size() const { return 0; }

 private:
  static constexpr std::size_t at_once = 2;
  static constexpr int most_directions = 2;

  /// One for each mesh.
  void add_maps() {
    std::map<const SupportMap*, std::int32_t> added;
    for (const Body& body : bodies_) {
      const SupportMap& map = body.hierarchy().supports();
      if (!added.contains(&map)) added[&map] = directions_.add(map);
      maps_.push_back(added[&map]);
    }
  }

  /// Tells pairs apart by balls, then by directions; those are in far_, the others in near_.
  template <class Counter>
  void find_near(Counter& counter) {
    near_count_ = far_count_ = 0;
    for (std::size_t p = 0; p < pairs_.size(); p += width) {
      const Indices numbers([&](auto lane) { return static_cast<std::int32_t>(p + lane); });
      const std::size_t used = std::min(width, pairs_.size() - p);
      split(numbers, used, directions_.balls_meet(pairs_of(numbers, used)));
    }
    const std::size_t meeting = std::exchange(near_count_, 0);
    for (std::size_t k = 0; k < meeting; k += width) {
      const Indices numbers(&near_[k], stdx::element_aligned);
      const std::size_t used = std::min(width, meeting - k);
      const auto pairs = pairs_of(numbers, used);
      auto direction = SeparatingDirections::normalized(pairs.between);
      split(numbers, used, ~bits(directions_.gaps(pairs, direction, most_directions) > 0.0f));
    }
    counter.tested(pairs_.size() + meeting);
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
  void split(const Indices& numbers, std::size_t used, std::uint64_t near) {
    alignas(64) std::array<std::int32_t, width> number;
    numbers.copy_to(number.data(), stdx::vector_aligned);
    for (std::size_t k = 0; k < used; ++k) {
      const std::size_t is_near = near >> k & 1;
      near_[near_count_] = far_[far_count_] = number[k];
      near_count_ += is_near, far_count_ += 1 - is_near;
    }
  }

  /// Bodies are placed when one of their pairs has to be looked at.
  template <class Query, class Counter, class Ask, class Take>
  void frame_from_memory(std::span<const Pose> poses, Counter& counter, Ask& ask, Take& take) {
    poses_ = poses;
    memory_.template move<Query>(poses);
    std::size_t due = 0;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (memory_.template stays<Query>(p, pairs_[p])) {
        auto query = ask(p);
        memory_.repeat(p, query);
        take(p, query);
      } else {
        near_[due++] = static_cast<std::int32_t>(p);
      }
    }
    before_ = counter.n_v + counter.n_p;
    counter.tested(due);
    near_count_ = due;
    if constexpr (!SeeksDistance<Query>) {
      leave_what_stays(due);
      tell_apart_due(counter);
      for (std::size_t k = 0; k < far_count_; ++k) {
        const auto p = static_cast<std::size_t>(far_[k]);
        counter.asked(before_);
        auto query = ask(p);
        memory_.repeat(p, query);
        take(p, query);
      }
    }
    take_turns<Query>(counter, ask, take);
  }

  /// Of the pairs that are due, those that are as far apart as they were go to far_.
  void leave_what_stays(std::size_t due) {
    near_count_ = far_count_ = 0;
    for (std::size_t k = 0; k < due; ++k) {
      const auto p = static_cast<std::size_t>(near_[k]);
      const std::size_t stays = memory_.stays_after_all(p, pairs_[p]);
      near_[near_count_] = far_[far_count_] = static_cast<std::int32_t>(p);
      near_count_ += 1 - stays, far_count_ += stays;
    }
  }
  /// Pairs without a front are looked at along directions.
  template <class Counter>
  void tell_apart_due(Counter& counter) {
    std::size_t with_front = 0;
    for (std::size_t k = 0; k < near_count_; ++k) {
      const auto p = static_cast<std::size_t>(near_[k]);
      if (memory_.has_front(p) || memory_.goes_on(p)) {
        std::swap(near_[k], near_[with_front++]);
      } else {
        stand(pairs_[p].i), stand(pairs_[p].j);
      }
    }
    const std::size_t due = std::exchange(near_count_, with_front);
    for (std::size_t k = with_front; k < due; k += width) {
      const Indices numbers(&near_[k], stdx::element_aligned);
      const std::size_t used = std::min(width, due - k);
      const auto pairs = pairs_of(numbers, used);
      auto direction = SeparatingDirections::normalized(pairs.between);
      const auto gaps = directions_.gaps(pairs, direction, most_directions);
      const std::uint64_t near = ~bits(gaps > 0.0f);
      for (std::size_t lane = 0; lane < used; ++lane)
        if (!(near >> lane & 1)) {
          const auto p = static_cast<std::size_t>(near_[k + lane]);
          memory_.apart(p, pairs_[p], gaps[lane]);
        }
      split(numbers, used, near);
    }
    counter.tested(due - with_front);
  }
  void stand(std::size_t body) { memory_.stand(body, directions_, maps_[body], origin_); }

  template <class Query, class Counter, class Ask, class Take>
  void take_turns(Counter& counter, Ask& ask, Take& take) {
    using Measure = std::conditional_t<SeeksDistance<Query>, NotMeasuring,
                                       typename Memory::template Measure<F>>;
    using Traversal = WideTraversal<V, F, Frame, Query, Counter, Measure>;
    std::array<Traversal, at_once> traversals{Traversal(workspaces_[0]), Traversal(workspaces_[1])};
    std::array<std::uint32_t, at_once> pair;
    std::size_t next = 0, active = 0;
    std::array<Traversal*, at_once> running;
    const auto begin = [&](std::size_t slot) {
      pair[slot] = static_cast<std::uint32_t>(near_[next++]);
      const auto [i, j] = pairs_[pair[slot]];
      if constexpr (Memory::remembers)
        place(bodies_[i], poses_[i], origin_), place(bodies_[j], poses_[j], origin_);
      if constexpr (Measure::measures)
        running[slot]->begin(bodies_[i], bodies_[j], ask(pair[slot]), counter,
                             memory_.template touched<Query>(pair[slot]), memory_.front(pair[slot]),
                             memory_.clock(pair[slot], pairs_[pair[slot]]));
      else
        running[slot]->begin(bodies_[i], bodies_[j], ask(pair[slot]), counter);
    };
    for (; active < at_once && next < near_count_; ++active) {
      running[active] = &traversals[active];
      begin(active);
    }
    while (active > 0)
      for (std::size_t slot = 0; slot < active;) {
        if (running[slot]->advance()) {
          ++slot;
          continue;
        }
        counter.asked(before_);
        if constexpr (Memory::remembers) remember(pair[slot], *running[slot]);
        take(pair[slot], running[slot]->query());
        if (next < near_count_) {
          begin(slot++);
        } else {
          --active;
          std::swap(running[slot], running[active]), std::swap(pair[slot], pair[active]);
        }
      }
  }

  template <class Traversal>
  void remember(std::size_t p, const Traversal& traversal) {
    using Query = std::remove_cvref_t<decltype(traversal.query())>;
    const ObjectPair& pair = pairs_[p];
    memory_.remember(p, pair, traversal.query(), traversal.measure());
    if constexpr (!SeeksDistance<Query> && Query::one_hit_is_enough)
      if (const auto crossing = traversal.measure().crossing();
          crossing && memory_.asks_how_long(p)) {
        const Triangle a = bodies_[pair.i].triangle(crossing->a),
                       b = bodies_[pair.j].triangle(crossing->b);
        const Triangle *first = &a, *second = &b;
        double margin = 0;
        if (touching_with_margins<>(&first, &second, 1, intersect_batch<Exact>, &margin))
          memory_.goes_on_touching(p, pair, margin);
      }
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Body> bodies_;
  std::vector<MeshBall> balls_;
  SeparatingDirections directions_;
  std::vector<std::int32_t> maps_;        // by which directions_ knows a body's mesh
  std::vector<std::int32_t> near_, far_;  // pairs
  std::size_t near_count_ = 0, far_count_ = 0;
  std::array<WideWorkspace, at_once> workspaces_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  [[no_unique_address]] Memory memory_;
  std::span<const Pose> poses_;
  std::uint64_t before_ = 0;  // what had been tested when the frame began
  bool placed_ = false;
};

}  // namespace bvlab
