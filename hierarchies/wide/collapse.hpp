// SPDX-License-Identifier: BSD-3-Clause
/// Collapses a binary topology into one with up to F children a node, by replacing nodes with their
/// children. Of all ways to do so it finds the one with the least total surface area of nodes,
/// which is proportional to the expected number of tests, by dynamic programming
/// (ylitie2017efficient). This fills nodes near the leaves, of which there are many, and leaves
/// lanes vacant near the root; opening the largest child until there are F (wald2008getting) does
/// the opposite and is a tenth slower. A subtree of at most `leaf_size` triangles becomes a leaf,
/// whose triangles are its children. O(n F^2).
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct WideTopology {
  struct Node {
    std::uint32_t first = 0;  ///< of its children, which are adjacent; leaf: of its primitives
    std::uint32_t count = 0;  ///< the number of children; leaf: of primitives
    bool leaf = false;
    std::uint32_t begin = 0, end = 0;  ///< the primitives below it
  };
  std::vector<Node> nodes;                ///< the root is node 0; level by level
  std::vector<std::uint32_t> primitives;  ///< triangle indices; those below a node are contiguous
};

namespace detail {

class Collapsing {
 public:
  Collapsing(const TriangleMesh& mesh, const Topology& binary) : binary_(binary) {
    const std::size_t n = binary.nodes.size();
    surface_.resize(n), begin_.resize(n), end_.resize(n);
    LargeVector<Eigen::AlignedBox3d> boxes(n);
    for (std::size_t i = n; i-- > 0;) {
      const auto& [first, count] = binary.nodes[i];
      if (count == 0) {
        boxes[i] = boxes[first].merged(boxes[first + 1]);
        begin_[i] = std::min(begin_[first], begin_[first + 1]);
        end_[i] = std::max(end_[first], end_[first + 1]);
      } else {
        begin_[i] = first, end_[i] = first + count;
        for (std::uint32_t k = first; k < first + count; ++k)
          for (const auto& corner : mesh.corners(binary.primitives[k])) boxes[i].extend(corner);
      }
      const Vec3<double> d = boxes[i].sizes();
      surface_[i] = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
  }

  WideTopology collapse(std::uint32_t fan_out, std::uint32_t leaf_size) {
    find_least_costs(fan_out, leaf_size);
    WideTopology wide;
    wide.primitives = binary_.primitives;
    std::vector<std::uint32_t> from{0};  // the binary node of each wide one
    for (std::size_t i = 0; i < from.size(); ++i) {
      const std::uint32_t b = from[i];
      WideTopology::Node node;
      node.begin = begin_[b], node.end = end_[b];
      node.leaf = is_leaf(b, leaf_size);
      if (node.leaf) {
        node.first = begin_[b], node.count = end_[b] - begin_[b];
      } else {
        node.first = static_cast<std::uint32_t>(from.size());
        add_children(b, fan_out, from);
        node.count = static_cast<std::uint32_t>(from.size()) - node.first;
      }
      wide.nodes.push_back(node);
    }
    return wide;
  }

 private:
  bool is_leaf(std::uint32_t b, std::uint32_t leaf_size) const {
    return binary_.nodes[b].count > 0 || end_[b] - begin_[b] <= leaf_size;
  }

  /// The best replacement of a binary subtree by at most a given number of wide nodes, from 1 to
  /// the fan-out.
  struct Cut {
    double cost = 0;
    std::uint32_t left = 0, right = 0;  ///< nodes given to each child; 0: one node for the subtree
  };
  /// The best cut of subtree b into at most `roots` nodes. A leaf has only one.
  Cut& cut(std::uint32_t b, std::uint32_t roots) {
    return cuts_[first_cut_[b] + (leaf_[b] ? 0 : roots - 1)];
  }

  /// Fills in all cuts, children before parents.
  void find_least_costs(std::uint32_t fan_out, std::uint32_t leaf_size) {
    const auto n = static_cast<std::uint32_t>(binary_.nodes.size());
    std::size_t needed = 0;
    for (std::uint32_t b = 0; b < n; ++b) {
      first_cut_.push_back(needed), leaf_.push_back(is_leaf(b, leaf_size));
      needed += leaf_[b] ? 1 : fan_out;
    }
    cuts_.resize(needed);
    for (std::uint32_t b = n; b-- > 0;) {
      cut(b, 1) = {surface_[b]};
      if (leaf_[b]) continue;
      for (std::uint32_t roots = 2; roots <= fan_out; ++roots) cut(b, roots) = shared(b, roots);
      cut(b, 1).cost += cut(b, fan_out).cost;
      for (std::uint32_t roots = 2; roots <= fan_out; ++roots)
        if (cut(b, roots - 1).cost < cut(b, roots).cost) cut(b, roots) = cut(b, roots - 1);
    }
  }
  /// The best way to divide `roots` nodes between the children of b.
  Cut shared(std::uint32_t b, std::uint32_t roots) {
    const std::uint32_t first = binary_.nodes[b].first;
    Cut best{std::numeric_limits<double>::infinity(), 1, roots - 1};
    for (std::uint32_t left = 1; left < roots; ++left) {
      const double cost = cut(first, left).cost + cut(first + 1, roots - left).cost;
      if (cost < best.cost) best = {cost, left, roots - left};
    }
    return best;
  }

  void add_children(std::uint32_t b, std::uint32_t roots, std::vector<std::uint32_t>& to) {
    const Cut& best = cut(b, roots);
    const std::uint32_t first = binary_.nodes[b].first;
    for (const auto& [child, share] :
         {std::pair(first, best.left), std::pair(first + 1, best.right)})
      if (cut(child, share).left == 0)
        to.push_back(child);
      else
        add_children(child, share, to);
  }

  const Topology& binary_;
  LargeVector<double> surface_;
  LargeVector<std::uint32_t> begin_, end_;
  std::vector<bool> leaf_;
  std::vector<std::size_t> first_cut_;  // index of each node's first cut in cuts_
  LargeVector<Cut> cuts_;
};

}  // namespace detail

/// A leaf of `binary` remains a leaf, so it must hold at most `fan_out` triangles.
inline WideTopology collapsed(const TriangleMesh& mesh, const Topology& binary,
                              std::uint32_t fan_out, std::uint32_t leaf_size) {
  return detail::Collapsing(mesh, binary).collapse(fan_out, leaf_size);
}

}  // namespace bvlab
