// SPDX-License-Identifier: BSD-3-Clause
/// The triangles of two leaves of block hierarchies, all pairs in sixteen lanes: lane 4 i + j holds
/// the i-th triangle of a and the j-th of b. Those of a are transformed into the frame of b, once.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "hierarchies/wide/lanes.hpp"
#include "traversal/node_pair.hpp"
#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/wide/leaf_tests.hpp"
#include "traversal/wide/relative_frame.hpp"
#include "traversal/wide/sixteen_lanes.hpp"

namespace bvlab {

/// Tree is a TreeInBlocks.
template <class Tree>
class BlockTriangles {
  using S = SixteenLanes;
  static constexpr std::size_t parts = 16 / S::size();

 public:
  /// transforms[0] takes points of a to b, transforms[1] back. Both arrays must outlive this.
  [[gnu::always_inline]] BlockTriangles(const std::array<const Tree*, 2>& trees,
                                        const std::array<CornerTransform, 2>& transforms,
                                        const NodePair& leaves)
      : trees_(trees),
        transforms_(transforms),
        node_{Tree::number_of(leaves.a), Tree::number_of(leaves.b)},
        a_(trees[0]->node(node_.a)),
        b_(trees[1]->node(node_.b)) {
    using Four = CornerTransform::Four;
    const auto& own = trees_[0]->corners(a_.first).corner;
    const auto from = [](const auto& p) { return Four(p.data(), stdx::vector_aligned); };
    for (std::size_t i = 0; i < 3; ++i) {
      const auto transformed = transforms_[0](from(own[i][0]), from(own[i][1]), from(own[i][2]));
      for (std::size_t k = 0; k < 3; ++k)
        transformed[k].copy_to(transformed_[i][k].data(), stdx::vector_aligned);
    }
  }

  std::uint64_t lanes() const { return four_by_four(a_.children, b_.children); }
  NodePair numbers(int lane) const {
    return {a_.first + static_cast<std::uint32_t>(lane / 4),
            b_.first + static_cast<std::uint32_t>(lane % 4)};
  }
  [[gnu::always_inline]] std::array<Corners<S>, 2> corners(std::size_t part) const {
    const auto& lanes = trees_[1]->corners(b_.first).corner;
    std::array<Corners<S>, 2> of;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        of[0][i][k] = each_of_four(transformed_[i][k].data(), part);
        of[1][i][k] = four_repeated(lanes[i][k].data(), part);
      }
    return of;
  }
  /// A lower bound on the distance of any pair; not positive where none is known.
  template <class Counter>
  float gap(Counter&) const {
    const auto gaps = triangle_gaps<S, parts>(*this, transforms_[0].error_bound());
    S least(std::numeric_limits<float>::infinity());
    for_each_part<S, parts>(lanes(),
                            [&](std::size_t part) { least = stdx::min(least, gaps[part]); });
    return stdx::hmin(least);
  }
  ReferenceSphere reference_sphere() const {
    return reference_sphere_of_smaller(trees_[0]->node_sphere(node_.a),
                                       trees_[1]->node_sphere(node_.b), transforms_);
  }

 private:
  const std::array<const Tree*, 2>& trees_;
  const std::array<CornerTransform, 2>& transforms_;
  NodePair node_;
  const typename Tree::Node &a_, &b_;
  alignas(16) std::array<std::array<std::array<float, 4>, 3>, 3> transformed_;
};

}  // namespace bvlab
