// SPDX-License-Identifier: BSD-3-Clause
/// Bodies that move from frame to frame, and every pair of them asked in every frame: the talk's
/// setting. Pairs stand in the order (0,1) (0,2) ... (0,n-1) (1,2) ...
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/gather.hpp"
#include "traversal/traverse.hpp"

namespace bvlab {

struct ObjectPair {
  std::uint32_t i, j;
};

/// (0,1) (0,2) ... (0,n-1) (1,2) ...: n(n-1)/2 pairs.
inline std::vector<ObjectPair> all_object_pairs(std::uint32_t objects) {
  std::vector<ObjectPair> pairs;
  for (std::uint32_t i = 0; i < objects; ++i)
    for (std::uint32_t j = i + 1; j < objects; ++j) pairs.push_back({i, j});
  return pairs;
}

/// A mesh and the hierarchy over it.
template <BoundingVolume V>
struct Shape {
  const TriangleMesh* mesh;
  const Hierarchy<V>* hierarchy;
};

/// The middle of the box around all translations: float volumes are posed relative to it, so that
/// their precision does not depend on where in the world the bodies are.
inline Vec3<double> middle_of(std::span<const Pose> poses) {
  if (poses.empty()) return Vec3<double>::Zero();
  Vec3<double> low = poses[0].translation, high = low;
  for (const auto& pose : poses) {
    low = low.cwiseMin(pose.translation);
    high = high.cwiseMax(pose.translation);
  }
  return low / 2 + high / 2;
}

/// B is the scalar or batch in which volumes are tested.
template <class B, BoundingVolume V, class Strategy>
class AllPairs {
 public:
  /// One body for each shape (which must outlive this), one copy of `strategy` for each pair.
  AllPairs(std::span<const Shape<V>> shapes, std::vector<ObjectPair> pairs,
           const Strategy& strategy)
      : pairs_(std::move(pairs)), strategies_(pairs_.size(), strategy) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) bodies_.emplace_back(*shape.mesh, *shape.hierarchy);
    if constexpr (roots_as_batches) {
      for (const auto& [i, j] : pairs_) asked_.push_back(i), asked_.push_back(j);
      std::sort(asked_.begin(), asked_.end());
      asked_.erase(std::unique(asked_.begin(), asked_.end()), asked_.end());
      roots_.resize(bodies_.size());
    }
  }

  /// Puts every body where its pose says, and asks every pair: `ask(pair)` makes the query for a
  /// pair (an index into `pairs()`), `take(pair, query)` gets it back with its answer.
  template <class Counter, class Ask, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, Ask&& ask, Take&& take) {
    if (!placed_) origin_ = middle_of(poses), placed_ = true;
    for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].move(poses[i], origin_);
    using Query = decltype(ask(std::size_t{0}));
    if constexpr (roots_as_batches && !wants_bound<Query>()) {
      frame_from_roots(counter, ask, take);
    } else {
      for (std::size_t p = 0; p < pairs_.size(); ++p) {
        auto query = ask(p);
        const std::uint64_t tested = counter.n_v + counter.n_p;
        strategies_[p].template run<B>(bodies_[pairs_[p].i], bodies_[pairs_[p].j], query, counter,
                                       workspace_);
        counter.asked(tested);
        take(p, query);
      }
    }
  }

  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  const Strategy& strategy(std::size_t pair) const { return strategies_[pair]; }

  /// The entries of all fronts together.
  std::size_t front_size() const {
    std::size_t sum = 0;
    for (const auto& strategy : strategies_) sum += strategy.front_size();
    return sum;
  }

 private:
  static constexpr int W = width<B>();
  static constexpr bool roots_as_batches = W > 1 && requires { typename Strategy::from_roots; };

  /// What is told apart at the roots is most of what there is where bodies are sparse, and costs a
  /// fraction if done for W pairs at once.
  template <class Counter, class Ask, class Take>
  void frame_from_roots(Counter& counter, Ask& ask, Take& take) {
    for (const std::uint32_t i : asked_) {
      bodies_[i].require(0, counter);
      roots_[i] = bodies_[i].volumes()[0];
    }
    std::uint64_t apart = 0;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      auto query = ask(p);
      if (p % W == 0) apart = roots_apart(p, query);
      const std::uint64_t tested = counter.n_v + counter.n_p;
      counter.tested(1);
      if (!(apart >> p % W & 1))
        traverse<B, BelowRoots<typename Strategy::from_roots>>(
            bodies_[pairs_[p].i], bodies_[pairs_[p].j], query, counter, workspace_);
      counter.asked(tested);
      take(p, query);
    }
  }

  /// Of the pairs from `first` on, as many as there are in a batch.
  template <class Query>
  std::uint64_t roots_apart(std::size_t first, const Query& query) const {
    std::array<std::uint32_t, W> a, b;
    for (std::size_t k = 0; k < W; ++k) {
      const ObjectPair& pair = pairs_[std::min(first + k, pairs_.size() - 1)];
      a[k] = pair.i, b[k] = pair.j;
    }
    return bits(query.excludes(gather<B>(roots_.data(), a.data()),
                               gather<B>(roots_.data(), b.data())));
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Strategy> strategies_;
  std::vector<Body<V>> bodies_;
  std::vector<std::uint32_t> asked_;  // the bodies that are in a pair
  std::vector<Posed<V>> roots_;       // of all bodies, side by side; only from roots
  Workspace workspace_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool placed_ = false;
};

}  // namespace bvlab
