// SPDX-License-Identifier: BSD-3-Clause
/// Time-critical collision detection, as hubbard1996approximating proposed for sphere trees: a
/// traversal of at most a given number of volume tests, the most promising pairs first. Its answer
/// is touching, apart, or not known yet with a bound on how deep one surface can have gone into the
/// other.
///
/// The bound. An open pair of nodes stands for two patches of surface. Let D be the smaller patch's
/// diameter in the world. If the patches share a point, no point of that patch is farther than D
/// from it, so none has gone deeper than D past the other surface there. Open pairs are kept in the
/// order of D, and the largest is expanded first: its D bounds them all.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "hierarchies/geometry/written_out.hpp"
#include "traversal/body.hpp"
#include "traversal/gather.hpp"
#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// For each node, an upper bound on the diameter of the patch of surface below it, in units of the
/// mesh: the diagonal of the patch's box, whatever the volume.
class PatchSizes {
 public:
  template <BoundingVolume V>
  PatchSizes(const TriangleMesh& mesh, const Hierarchy<V>& hierarchy) : sizes_(hierarchy.size()) {
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

enum class Known : std::uint8_t { apart, touching, not_yet };

struct BudgetedAnswer {
  Known known = Known::not_yet;
  double deepest = 0;       ///< bound on the depth, in units of the mesh; 0 unless not_yet
  std::uint64_t tests = 0;  ///< volume tests made
};

/// The algorithm, with buffers kept between calls. B is the scalar or batch in which volumes are
/// tested: a step tests as many pairs as B has lanes, and all steps together no more than the
/// budget.
template <class B, BoundingVolume V>
class Budgeted {
  static constexpr int W = width<B>();

 public:
  /// `test` decides candidates as in `Touching`. The sizes belong to the bodies' hierarchies.
  template <class Counter>
  BudgetedAnswer operator()(Body<V>& a, const PatchSizes& sizes_a, Body<V>& b,
                            const PatchSizes& sizes_b, std::uint64_t budget, TriangleTest test,
                            Counter& counter) {
    queue_.clear();
    pending_.clear();
    BudgetedAnswer answer;
    a.require(0, counter);
    b.require(0, counter);
    push({std::min(sizes_a[0], sizes_b[0]), 0, 0});
    while (!queue_.empty() && answer.tests < budget) {
      const int count = take(budget - answer.tests);
      answer.tests += static_cast<std::uint64_t>(count);
      counter.tested(static_cast<std::uint64_t>(count));
      std::uint64_t open = ~excluded(a, b, count) & ((std::uint64_t{2} << (count - 1)) - 1);
      bool hit = false;
      for (; open && !hit; open &= open - 1)
        hit = split(a, sizes_a, b, sizes_b, std::countr_zero(open), test, counter);
      if (hit || one_touches(test, counter)) {
        answer.known = Known::touching;
        return answer;
      }
    }
    if (queue_.empty())
      answer.known = Known::apart;
    else
      answer.deepest = deepest(a, b);
    return answer;
  }

 private:
  struct InQuestion {
    float size;
    std::uint32_t a, b;
    bool operator<(const InQuestion& other) const { return size < other.size; }
  };

  void push(const InQuestion& pair) {
    queue_.push_back(pair);
    std::push_heap(queue_.begin(), queue_.end());
  }

  int take(std::uint64_t most) {
    int count = 0;
    for (; count < W && !queue_.empty() && static_cast<std::uint64_t>(count) < most; ++count) {
      std::pop_heap(queue_.begin(), queue_.end());
      nodes_a_[count] = queue_.back().a, nodes_b_[count] = queue_.back().b;
      queue_.pop_back();
    }
    for (int i = count; i < W; ++i) nodes_a_[i] = nodes_a_[0], nodes_b_[i] = nodes_b_[0];
    return count;
  }

  std::uint64_t excluded(const Body<V>& a, const Body<V>& b, int) const {
    if constexpr (W == 1)
      return bits(disjoint(a.volumes()[nodes_a_[0]], b.volumes()[nodes_b_[0]]));
    else
      return bits(disjoint(gather<B>(a.volumes(), nodes_a_.data()),
                           gather<B>(b.volumes(), nodes_b_.data())));
  }

  /// Tests the held candidates and discards them. Returns whether one of them touches.
  template <class Counter>
  bool one_touches(TriangleTest test, Counter& counter) {
    counter.primitives(pending_.size());
    const bool hit =
        for_each_hit(pending_, test, [](std::size_t) { return true; }) < pending_.size();
    pending_.clear();
    return hit;
  }

  /// Puts the pairs of children into the queue, or holds the candidates of two leaves. Candidates
  /// are tested when too many are held, however large the leaves are. Returns whether one touches.
  template <class Counter>
  bool split(Body<V>& a, const PatchSizes& sizes_a, Body<V>& b, const PatchSizes& sizes_b, int lane,
             TriangleTest test, Counter& counter) {
    constexpr std::size_t portion = 4096;
    const std::uint32_t i = nodes_a_[lane], j = nodes_b_[lane];
    const auto& node_a = a.hierarchy().node(i);
    const auto& node_b = b.hierarchy().node(j);
    if (node_a.count && node_b.count) {
      for (std::uint32_t s = node_a.first; s < node_a.first + node_a.count; ++s)
        for (std::uint32_t t = node_b.first; t < node_b.first + node_b.count; ++t) {
          pending_.push_back({&a.triangle(s), &b.triangle(t), 0, 0, 0});
          if (pending_.size() == portion && one_touches(test, counter)) return true;
        }
    } else if (node_a.count || (!node_b.count && sizes_b[j] > sizes_a[i])) {
      b.require(node_b.first, counter);
      for (std::uint32_t child = node_b.first; child < node_b.first + node_b.children; ++child)
        push({std::min(sizes_a[i], sizes_b[child]), i, child});
    } else {
      a.require(node_a.first, counter);
      for (std::uint32_t child = node_a.first; child < node_a.first + node_a.children; ++child)
        push({std::min(sizes_a[child], sizes_b[j]), child, j});
    }
    return false;
  }

  /// The largest size, enlarged for rotations that are not quite orthonormal and for rounding to
  /// float64.
  double deepest(const Body<V>& a, const Body<V>& b) const {
    const double stretch = std::max(stretch_of(a.pose()), stretch_of(b.pose()));
    const double grain = 16 * unit_roundoff<double> *
                         (a.pose().translation.norm() + a.extent().reach +
                          b.pose().translation.norm() + b.extent().reach);
    return static_cast<double>(queue_.front().size) * stretch + grain;
  }
  /// |R x| <= |x| sqrt(1 + |R'R - I|), the defect computed with an error below 16 u.
  static double stretch_of(const Pose& pose) {
    const Mat3<double> defect =
        pose.rotation.transpose() * pose.rotation - Mat3<double>::Identity();
    return std::sqrt(1 + defect.norm() + 32 * unit_roundoff<double>);
  }

  std::vector<InQuestion> queue_;  // a heap
  std::vector<Candidate> pending_;
  std::array<std::uint32_t, W> nodes_a_, nodes_b_;
};

}  // namespace bvlab
