// SPDX-License-Identifier: BSD-3-Clause
/// A topology with up to F children a node, made of a binary one: a node takes the place of its
/// children's parents, the one with the largest surface first (wald2008getting), until it has F
/// children. What holds at most `leaf_size` triangles becomes a leaf, whose triangles are its
/// children. O(n F).
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct WideTopology {
  struct Node {
    std::uint32_t first = 0;  ///< of its children, which are adjacent; leaf: of its primitives
    std::uint32_t count = 0;  ///< how many those are
    bool leaf = false;
    std::uint32_t begin = 0, end = 0;  ///< the primitives below it
  };
  std::vector<Node> nodes;                ///< the root is node 0; level by level
  std::vector<std::uint32_t> primitives;  ///< triangle indices, those below a node adjacent
};

namespace detail {

class Collapsing {
 public:
  Collapsing(const TriangleMesh& mesh, const Topology& binary) : binary_(binary) {
    const std::size_t n = binary.nodes.size();
    surface_.resize(n), begin_.resize(n), end_.resize(n);
    std::vector<Eigen::AlignedBox3d> boxes(n);
    for (std::size_t i = n; i-- > 0;) {
      const auto& [first, count] = binary.nodes[i];
      if (count == 0) {
        boxes[i] = boxes[first].merged(boxes[first + 1]);
        begin_[i] = std::min(begin_[first], begin_[first + 1]);
        end_[i] = std::max(end_[first], end_[first + 1]);
      } else {
        begin_[i] = first, end_[i] = first + count;
        for (std::uint32_t place = first; place < first + count; ++place)
          for (const auto& corner : mesh.corners(binary.primitives[place])) boxes[i].extend(corner);
      }
      const Vec3<double> d = boxes[i].sizes();
      surface_[i] = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
  }

  WideTopology collapse(std::uint32_t fan_out, std::uint32_t leaf_size) const {
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
        for (const auto child : children_of(b, fan_out, leaf_size)) from.push_back(child);
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

  std::vector<std::uint32_t> children_of(std::uint32_t b, std::uint32_t fan_out,
                                         std::uint32_t leaf_size) const {
    std::vector<std::uint32_t> children{b};
    while (children.size() < fan_out) {
      std::size_t largest = children.size();
      for (std::size_t k = 0; k < children.size(); ++k)
        if (!is_leaf(children[k], leaf_size) &&
            (largest == children.size() || surface_[children[k]] > surface_[children[largest]]))
          largest = k;
      if (largest == children.size()) break;
      const std::uint32_t first = binary_.nodes[children[largest]].first;
      children[largest] = first;
      children.push_back(first + 1);
    }
    return children;
  }

  const Topology& binary_;
  std::vector<double> surface_;
  std::vector<std::uint32_t> begin_, end_;
};

}  // namespace detail

/// A leaf of the binary topology stays one: it must hold at most `fan_out` triangles.
inline WideTopology collapsed(const TriangleMesh& mesh, const Topology& binary,
                              std::uint32_t fan_out, std::uint32_t leaf_size) {
  return detail::Collapsing(mesh, binary).collapse(fan_out, leaf_size);
}

}  // namespace bvlab
