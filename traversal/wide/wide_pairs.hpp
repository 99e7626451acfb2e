// SPDX-License-Identifier: BSD-3-Clause
/// Bodies over wide trees that move from frame to frame, and pairs of them asked in every frame:
/// AllPairs' sibling. Balls around the bodies dismiss what is far apart; what is near takes turns,
/// two pairs at a time.
///
/// What is remembered from one frame to the next is a policy: nothing (Forgetful), so that every
/// pair starts from the roots, or how long answers stay (WideMargins).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

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
  WidePairs(std::span<const WideShape<V, F>> shapes, std::vector<ObjectPair> pairs)
      : pairs_(std::move(pairs)) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) {
      bodies_.emplace_back(*shape.mesh, *shape.hierarchy);
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
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      place(bodies_[i], poses[i], origin_);
      centres_[i] = poses[i](balls_[i].centre);
      // What is off, of a corner and of the centre, and of how far they are apart.
      reaches_[i] = (balls_[i].radius + 4 * bodies_[i].orthonormal_pose().noise) *
                    (1 + 16 * unit_roundoff<double>);
    }
    std::size_t near = pairs_.size();
    before_ = counter.n_v + counter.n_p;
    if constexpr (!SeeksDistance<Query>) {
      near = find_near(counter);
      for (std::size_t k = near; k < pairs_.size(); ++k) {
        counter.asked(before_);
        take(near_[k], ask(near_[k]));
      }
    } else {
      for (std::size_t k = 0; k < near; ++k) near_[k] = static_cast<std::uint32_t>(k);
    }
    take_turns<Query>(near, counter, ask, take);
  }

  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  /// No front is kept.
  std::size_t front_size() const { return 0; }

 private:
  static constexpr std::size_t at_once = 2;

  /// Puts the pairs whose balls meet before the others; says how many they are.
  template <class Counter>
  std::size_t find_near(Counter& counter) {
    std::size_t near = 0, far = pairs_.size();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      const auto [i, j] = pairs_[p];
      const double reach = reaches_[i] + reaches_[j];
      const bool meet = !((centres_[i] - centres_[j]).squaredNorm() > reach * reach);
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
    memory_.template move<Query>(poses);
    std::size_t due = 0;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (memory_.template stays<Query>(p, pairs_[p])) {
        auto query = ask(p);
        memory_.repeat(p, query);
        take(p, query);
      } else {
        near_[due++] = static_cast<std::uint32_t>(p);
      }
    }
    before_ = counter.n_v + counter.n_p;
    counter.tested(due);
    std::size_t near = 0;
    for (std::size_t k = 0; k < due; ++k) {
      const std::uint32_t p = near_[k];
      if constexpr (!SeeksDistance<Query>)
        if (memory_.stays_after_all(p, pairs_[p]) || memory_.balls_apart(p, pairs_[p])) {
          counter.asked(before_);
          take(p, ask(p));
          continue;
        }
      near_[near++] = p;
    }
    take_turns<Query>(near, counter, ask, take);
  }

  template <class Query, class Counter, class Ask, class Take>
  void take_turns(std::size_t near, Counter& counter, Ask& ask, Take& take) {
    using Measure = std::conditional_t<SeeksDistance<Query>, NotMeasuring,
                                       typename Memory::template Measure<F>>;
    using Traversal = WideTraversal<V, F, Frame, Query, Counter, Measure>;
    std::array<Traversal, at_once> traversals{Traversal(workspaces_[0]), Traversal(workspaces_[1])};
    std::array<std::uint32_t, at_once> pair;
    std::size_t next = 0, active = 0;
    std::array<Traversal*, at_once> running;
    const auto begin = [&](std::size_t slot) {
      pair[slot] = near_[next++];
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
    for (; active < at_once && next < near; ++active) {
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
        if constexpr (Memory::remembers)
          memory_.remember(pair[slot], pairs_[pair[slot]], running[slot]->query(),
                           running[slot]->measure());
        take(pair[slot], running[slot]->query());
        if (next < near) {
          begin(slot++);
        } else {
          --active;
          std::swap(running[slot], running[active]), std::swap(pair[slot], pair[active]);
        }
      }
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Body> bodies_;
  std::vector<MeshBall> balls_;
  std::vector<Vec3<double>> centres_;
  std::vector<double> reaches_;
  std::vector<std::uint32_t> near_;  // pairs, near ones first
  std::array<WideWorkspace, at_once> workspaces_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  [[no_unique_address]] Memory memory_;
  std::span<const Pose> poses_;
  std::uint64_t before_ = 0;  // what had been tested when the frame began
  bool placed_ = false;
};

}  // namespace bvlab
