// SPDX-License-Identifier: BSD-3-Clause
/// Bodies that move from frame to frame, and every pair of them asked in every frame: the talk's
/// setting. Pairs stand in the order (0,1) (0,2) ... (0,n-1) (1,2) ...
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
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

/// A strategy of which somebody else may test the two roots, for many pairs at once:
///   starts_at_roots()     whether the next run begins with that
///   roots_are_apart()     it did, and there was nothing more to do
///   run_below_roots(...)  like `run`, where they are not apart
/// One query says for all pairs of a batch whether roots are apart.
template <class S>
concept RootsFirst = requires(S strategy) {
  { strategy.starts_at_roots() } -> std::same_as<bool>;
  strategy.roots_are_apart();
};

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
      fresh_.resize(pairs_.size());
      apart_.resize(pairs_.size());
      wanted_.resize(bodies_.size());
      roots_.resize(bodies_.size());
    }
  }

  /// Puts every body where its pose says, and asks every pair: `ask(pair)` makes the query for a
  /// pair (an index into `pairs()`), `take(pair, query)` gets it back with its answer; one is made
  /// for each batch of roots besides, of which nothing is taken.
  template <class Counter, class Ask, class Take>
  void frame(std::span<const Pose> poses, Counter& counter, Ask&& ask, Take&& take) {
    if (!placed_) origin_ = middle_of(poses), placed_ = true;
    for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].move(poses[i], origin_);
    constexpr bool roots_first =
        roots_as_batches && !wants_bound<std::remove_cvref_t<decltype(ask(0))>>();
    if constexpr (roots_first) find_roots_apart(counter, ask);
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      auto query = ask(p);
      const std::uint64_t tested = counter.n_v + counter.n_p;
      Body<V>&a = bodies_[pairs_[p].i], &b = bodies_[pairs_[p].j];
      if constexpr (roots_first) {
        const bool from_roots = strategies_[p].starts_at_roots();
        if (from_roots) {
          counter.tested(1);
        }
        if (!from_roots)
          strategies_[p].template run<B>(a, b, query, counter, workspace_);
        else if (apart_[p])
          strategies_[p].roots_are_apart();
        else
          strategies_[p].template run_below_roots<B>(a, b, query, counter, workspace_);
      } else {
        strategies_[p].template run<B>(a, b, query, counter, workspace_);
      }
      counter.asked(tested);
      take(p, query);
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
  static constexpr bool roots_as_batches = W > 1 && RootsFirst<Strategy>;

  /// Of the pairs whose next run starts at the roots: which roots are apart. That is most of what
  /// there is to do where bodies are sparse, and costs a fraction if done for W pairs at once.
  template <class Counter, class Ask>
  void find_roots_apart(Counter& counter, Ask& ask) {
    std::size_t count = 0;
    for (std::uint32_t p = 0; p < pairs_.size(); ++p) {
      if (!strategies_[p].starts_at_roots()) continue;
      fresh_[count++] = p;
      wanted_[pairs_[p].i] = wanted_[pairs_[p].j] = 1;
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!wanted_[i]) continue;
      bodies_[i].require(0, counter);
      roots_[i] = bodies_[i].volumes()[0];
      wanted_[i] = 0;
    }
    for (std::size_t first = 0; first < count; first += W) {
      auto query = ask(fresh_[first]);
      std::array<std::uint32_t, W> a, b;
      for (std::size_t k = 0; k < W; ++k) {
        const ObjectPair& pair = pairs_[fresh_[std::min(first + k, count - 1)]];
        a[k] = pair.i, b[k] = pair.j;
      }
      const std::uint64_t apart = bits(
          query.excludes(gather<B>(roots_.data(), a.data()), gather<B>(roots_.data(), b.data())));
      for (std::size_t k = 0; k < W && first + k < count; ++k)
        apart_[fresh_[first + k]] = apart >> k & 1;
    }
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Strategy> strategies_;
  std::vector<Body<V>> bodies_;
  // Only where roots are tested first:
  std::vector<std::uint32_t> fresh_;  // the pairs for which that is done
  std::vector<std::uint8_t> apart_;   // for each pair
  std::vector<std::uint8_t> wanted_;  // for each body, whether it is in one of them
  std::vector<Posed<V>> roots_;       // of all bodies, side by side
  Workspace workspace_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool placed_ = false;
};

}  // namespace bvlab
