// SPDX-License-Identifier: BSD-3-Clause
/// Time-critical collision detection, as hubbard1996approximating proposed for sphere trees: a
/// traversal with a budget of volume tests. The answer is touching, apart, or not known yet, with a
/// bound on the size of a crossing that has not been found yet.
///
/// The bound. An undecided pair of nodes stands for two patches of surface. Let D be the smaller
/// patch's diameter in the world. If the patches share a point, every point of that patch is within
/// D of it, so the patch reaches at most D behind the other surface. It is not a bound on the depth
/// of penetration: parts of a body that lie deep inside another one are apart from its surface, and
/// their pairs are culled. Pairs are expanded in the order of D, largest first: the D of the next
/// one bounds all others.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hierarchies/geometry/small_matrices.hpp"
#include "traversal/body.hpp"
#include "traversal/no_front.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/traverse.hpp"

namespace bvlab {

/// For each node, an upper bound on the diameter of the patch of surface below it, in units of the
/// mesh: the diagonal of the patch's box, whatever the volume.
class PatchSizes {
 public:
  PatchSizes(const TriangleMesh& mesh, const Tree& hierarchy) : sizes_(hierarchy.size()) {
    std::vector<std::array<Vec3<double>, 2>> boxes(hierarchy.size());
    // Children come after their parent.
    for (std::size_t i = hierarchy.size(); i-- > 0;) {
      const auto& node = hierarchy.node(static_cast<std::uint32_t>(i));
      auto& [low, high] = boxes[i];
      if (node.count == 0) {
        low = boxes[node.first][0], high = boxes[node.first][1];
        for (std::uint32_t child = node.first + 1; child < node.first + node.children; ++child)
          low = low.cwiseMin(boxes[child][0]), high = high.cwiseMax(boxes[child][1]);
      } else {
        low = high = mesh.corners(hierarchy.primitive(node.first))[0];
        for (std::uint32_t index = node.first; index < node.first + node.count; ++index)
          for (const auto& p : mesh.corners(hierarchy.primitive(index)))
            low = low.cwiseMin(p), high = high.cwiseMax(p);
      }
      // The difference, the norm's five operations and the rounding to float: less than 2^-20.
      const double diagonal = stable_norm(high - low) * (1 + 0x1p-20);
      sizes_[i] = rounded_up<float>(diagonal);
    }
  }

  float operator[](std::uint32_t node) const { return sizes_[node]; }

 private:
  std::vector<float> sizes_;
};

enum class BudgetVerdict : std::uint8_t { apart, touching, not_yet };

struct BudgetedAnswer {
  BudgetVerdict verdict = BudgetVerdict::not_yet;
  double deepest = 0;       ///< the largest D, in units of the mesh; 0 unless not_yet
  std::uint64_t tests = 0;  ///< volume tests made
};

/// A pair of nodes that may touch, and the diameter of its smaller patch.
struct PairOfPatches {
  float size;
  NodePair pair;
  bool operator<(const PairOfPatches& other) const { return size < other.size; }
};

/// The front of a traversal within a budget. Its sweep is the whole run: it tests the largest pairs
/// first, as many at once as there are lanes. Pairs left in the queue at the end are undecided.
class LargestFirst : public NoFront {
 public:
  /// The sizes belong to the hierarchies that are traversed. The queue, a heap, must be empty.
  LargestFirst(const PatchSizes& sizes_a, const PatchSizes& sizes_b, std::uint64_t budget,
               std::vector<PairOfPatches>& queue)
      : sizes_a_(sizes_a), sizes_b_(sizes_b), left_(budget), queue_(queue) {}

  template <class Traversal>
  bool sweep(Traversal& traversal) {
    push({0, 0});
    bool satisfied = false;
    while (!queue_.empty() && left_ > 0 && !satisfied) {
      std::array<NodePair, Traversal::W> taken;
      const std::size_t count = take(taken);
      const std::uint64_t culled = traversal.culled(count, [&](std::size_t i) { return taken[i]; });
      for (std::size_t i = 0; i < count; ++i)
        if (!(culled >> i & 1)) expand(traversal, taken[i]);
      satisfied = traversal.flush();
    }
    return satisfied;
  }

 private:
  void push(const NodePair& pair) {
    queue_.push_back({std::min(sizes_a_[pair.a], sizes_b_[pair.b]), pair});
    std::push_heap(queue_.begin(), queue_.end());
  }

  template <std::size_t W>
  std::size_t take(std::array<NodePair, W>& taken) {
    std::size_t count = 0;
    for (; count < W && !queue_.empty() && left_ > 0; ++count, --left_) {
      std::pop_heap(queue_.begin(), queue_.end());
      taken[count] = queue_.back().pair;
      queue_.pop_back();
    }
    return count;
  }

  /// Buffers the primitives of two leaves; replaces any other pair by the pairs with the children
  /// of the larger patch.
  template <class Traversal>
  void expand(Traversal& traversal, const NodePair& pair) {
    const auto& a = traversal.a().node(pair.a);
    const auto& b = traversal.b().node(pair.b);
    if (a.count && b.count) return traversal.hold(pair);
    if (a.count || (!b.count && sizes_b_[pair.b] > sizes_a_[pair.a]))
      for (std::uint32_t k = 0; k < b.children; ++k) push({pair.a, b.first + k});
    else
      for (std::uint32_t k = 0; k < a.children; ++k) push({a.first + k, pair.b});
  }

  const PatchSizes &sizes_a_, &sizes_b_;
  std::uint64_t left_;
  std::vector<PairOfPatches>& queue_;
};

/// The algorithm, with buffers kept between calls. A step tests up to W pairs at once, and all
/// steps together no more than the budget.
template <std::size_t W>
class Budgeted {
 public:
  /// `test` decides candidates as in `Touching`. The sizes belong to the bodies' hierarchies, and
  /// `tests_between` to their volumes.
  template <class Counter>
  BudgetedAnswer operator()(TreeBody& a, const PatchSizes& sizes_a, TreeBody& b,
                            const PatchSizes& sizes_b, TestsBetween<Touching> tests_between,
                            std::uint64_t budget, TriangleTest test, Counter& counter) {
    queue_.clear();
    Touching query(test);
    const auto statistics = traverse<W>(a, b, tests_between(a, b, workspace_), query, workspace_,
                                        LargestFirst(sizes_a, sizes_b, budget, queue_));
    statistics.count(counter);
    BudgetedAnswer answer;
    answer.tests = statistics.volumes;
    if (query.touching())
      answer.verdict = BudgetVerdict::touching;
    else if (queue_.empty())
      answer.verdict = BudgetVerdict::apart;
    else
      answer.deepest = deepest(a, b);
    return answer;
  }

 private:
  /// The largest size, enlarged for rotations that are not quite orthonormal and for rounding to
  /// float64.
  double deepest(const MovingBody& a, const MovingBody& b) const {
    const double stretch = std::max(stretch_of(a.pose()), stretch_of(b.pose()));
    const double grain = 16 * unit_roundoff<double> *
                         (a.pose().translation.norm() + a.extent().reach +
                          b.pose().translation.norm() + b.extent().reach +
                          (a.extent().origin.norm() + b.extent().origin.norm()));
    return static_cast<double>(queue_.front().size) * stretch + grain;
  }
  /// |R x| <= |x| sqrt(1 + |R'R - I|), the defect computed with an error below 16 u.
  static double stretch_of(const Pose& pose) {
    const Mat3<double> defect =
        pose.rotation.transpose() * pose.rotation - Mat3<double>::Identity();
    return std::sqrt(1 + defect.norm() + 32 * unit_roundoff<double>);
  }

  Workspace workspace_;
  std::vector<PairOfPatches> queue_;  // a heap
};

}  // namespace bvlab
