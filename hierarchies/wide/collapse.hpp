// SPDX-License-Identifier: BSD-3-Clause
/// Collapses a binary topology into one with up to F children per node, by replacing nodes with
/// their children. Of all ways to do so it finds the one with the least total surface area of
/// nodes, which is proportional to the expected number of tests, by dynamic programming
/// (ylitie2017efficient). This fills nodes near the leaves, of which there are many, and leaves
/// lanes vacant near the root; opening the largest child until there are F (wald2008getting) does
/// the opposite and is a tenth slower. A subtree of at most `leaf_size` triangles becomes a leaf,
/// whose triangles are its children. O(n F) steps of a register of 16 sums.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

namespace detail {

// A template, so that only those who call it compile it.
template <class = double>
class Collapsing {
 public:
  static constexpr std::uint32_t most = 16;  ///< the largest fan-out

  Collapsing(const TriangleMesh& mesh, const Topology& binary, std::uint32_t leaf_size)
      : binary_(binary) {
    take_nodes(leaf_size);
    surface_.resize(nodes_.size());
    LargeVector<Box> boxes(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const Node& node = nodes_[i];
      Box box;
      if (node.leaf()) {
        for (std::uint32_t k = node.begin; k < node.end; ++k)
          for (const std::uint32_t v : mesh.triangles[binary.primitives[k]])
            box.extend(mesh.vertices[v]);
      } else {
        box = boxes[node.first], box.extend(boxes[node.first + 1]);
      }
      boxes[i] = box;
      const Vec3<double> d = box.high - box.low;
      surface_[i] = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
  }

  WideTopology collapse(std::uint32_t fan_out) {
    assert(fan_out <= most);
    find_least_costs(fan_out);
    WideTopology wide;
    wide.primitives = binary_.primitives;
    std::vector<std::uint32_t> from{0};  // the binary node of each wide one
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Node& b = nodes_[from[i]];
      WideTopology::Node node;
      node.begin = b.begin, node.end = b.end;
      node.leaf = b.leaf();
      if (node.leaf) {
        node.first = b.begin, node.count = b.end - b.begin;
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
  /// A box without the checks of Eigen's for emptiness.
  struct Box {
    Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity());
    Vec3<double> high = -low;

    void extend(const Vec3<double>& point) {
      low = low.cwiseMin(point), high = high.cwiseMax(point);
    }
    void extend(const Box& other) {
      low = low.cwiseMin(other.low), high = high.cwiseMax(other.high);
    }
  };
  /// A binary node that is not below a leaf of the result.
  struct Node {
    static constexpr std::uint32_t none = 0xffffffff;
    std::uint32_t first, begin, end;  ///< the first of two adjacent children; the primitives
    std::uint32_t cuts;               ///< the index of its cuts; a leaf has none

    bool leaf() const { return cuts == none; }
  };

  /// Numbers the nodes that are not below a leaf. Children come after their parent, as in `binary`.
  void take_nodes(std::uint32_t leaf_size) {
    const std::size_t n = binary_.nodes.size();
    LargeVector<std::uint32_t> begin(n), end(n), number(n);
    for (std::size_t i = n; i-- > 0;) {
      const auto& [first, count] = binary_.nodes[i];
      begin[i] = count ? first : std::min(begin[first], begin[first + 1]);
      end[i] = count ? first + count : std::max(end[first], end[first + 1]);
      number[i] = 0;
    }
    number[0] = 1;
    std::uint32_t numbered = 0, inner = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!number[i]) continue;
      number[i] = numbered++;
      const auto& [first, count] = binary_.nodes[i];
      const bool leaf = count > 0 || end[i] - begin[i] <= leaf_size;
      nodes_.push_back({first, begin[i], end[i], leaf ? Node::none : inner++});
      if (!leaf) number[first] = number[first + 1] = 1;
    }
    for (Node& node : nodes_)
      if (!node.leaf()) node.first = number[node.first];
  }

  /// The cheapest replacement of a binary subtree by at most k wide nodes, at index k - 1: its
  /// cost, and how many of the nodes go to the left and to the right child. 0: the subtree becomes
  /// one node.
  struct Cuts {
    std::array<double, most> cost;
    std::array<std::uint8_t, most> left, right;
  };

  /// Fills in all cuts, children before parents.
  void find_least_costs(std::uint32_t fan_out) {
    cuts_.resize(nodes_.size() / 2);
    for (std::size_t b = nodes_.size(); b-- > 0;) {
      const Node& node = nodes_[b];
      if (node.leaf()) continue;
      Cuts& cuts = cuts_[node.cuts];
      share(node, fan_out, cuts);
      cuts.cost[0] = surface_[b] + cuts.cost[fan_out - 1];
      cuts.left[0] = cuts.right[0] = 0;
      for (std::uint32_t k = 1; k < fan_out; ++k)
        if (cuts.cost[k - 1] < cuts.cost[k])
          cuts.cost[k] = cuts.cost[k - 1], cuts.left[k] = cuts.left[k - 1],
          cuts.right[k] = cuts.right[k - 1];
    }
  }
  /// The costs of child b as [roots - 1]. A leaf is one node whatever it is given.
  const double* costs(std::uint32_t b, std::array<double, most>& of_leaf) const {
    if (!nodes_[b].leaf()) return cuts_[nodes_[b].cuts].cost.data();
    of_leaf.fill(surface_[b]);
    return of_leaf.data();
  }
  /// The best ways to divide 2, 3, ... nodes between the children; of equal ones, the one that
  /// gives the left child least. A division that leaves the right child none costs infinity, so
  /// that all inner loops have one length.
  void share(const Node& node, std::uint32_t fan_out, Cuts& cuts) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    std::array<double, most> of_leaf, best, given;
    std::array<double, 2 * most> of_right;
    std::fill_n(of_right.begin(), most, infinite);
    std::copy_n(costs(node.first + 1, of_leaf), most, of_right.begin() + most);
    const double* const of_left = costs(node.first, of_leaf);
    best.fill(infinite), given.fill(1);
    for (std::uint32_t left = 1; left < fan_out; ++left) {
      const double* const rest = of_right.data() + most - left;
      for (std::uint32_t k = 0; k < most; ++k) {
        const double cost = of_left[left - 1] + rest[k];
        const bool less = cost < best[k];
        best[k] = less ? cost : best[k], given[k] = less ? left : given[k];
      }
    }
    for (std::uint32_t k = 1; k < most; ++k) {
      cuts.cost[k] = best[k];
      cuts.left[k] = static_cast<std::uint8_t>(given[k]);
      cuts.right[k] = static_cast<std::uint8_t>(k + 1 - cuts.left[k]);
    }
  }

  void add_children(const Node& b, std::uint32_t roots, std::vector<std::uint32_t>& to) const {
    const Cuts& cuts = cuts_[b.cuts];
    for (const auto& [child, share] : {std::pair(b.first, cuts.left[roots - 1]),
                                       std::pair(b.first + 1, cuts.right[roots - 1])}) {
      const Node& node = nodes_[child];
      if (node.leaf() || cuts_[node.cuts].left[share - 1] == 0)
        to.push_back(child);
      else
        add_children(node, share, to);
    }
  }

  const Topology& binary_;
  std::vector<Node> nodes_;
  LargeVector<double> surface_;
  LargeVector<Cuts> cuts_;
};

}  // namespace detail

/// A leaf of `binary` remains a leaf, so it must hold at most `fan_out` triangles.
template <class = double>
WideTopology collapsed(const TriangleMesh& mesh, const Topology& binary, std::uint32_t fan_out,
                       std::uint32_t leaf_size) {
  return detail::Collapsing<>(mesh, binary, leaf_size).collapse(fan_out);
}

/// The same tree with at most `most` children per node, of which there were at most the square of
/// that: the children of a wider node are put in rows, each a node of its own.
template <class = double>
WideTopology in_rows(const WideTopology& wide, std::uint32_t most) {
  /// Some siblings; alone, the node itself.
  struct Row {
    std::span<const std::uint32_t> nodes;
  };
  std::vector<std::vector<std::uint32_t>> children(wide.nodes.size());
  std::vector<std::uint32_t> root{0};
  std::vector<Row> rows{{root}};
  WideTopology result;
  result.primitives = wide.primitives;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::span<const std::uint32_t> below = rows[i].nodes;
    WideTopology::Node node;
    node.begin = wide.nodes[below.front()].begin, node.end = wide.nodes[below.back()].end;
    if (below.size() == 1) {
      const WideTopology::Node& from = wide.nodes[below[0]];
      if (from.leaf) {
        result.nodes.push_back(from);
        continue;
      }
      auto& of = children[below[0]];
      for (std::uint32_t k = 0; k < from.count; ++k) of.push_back(from.first + k);
      // What is in a row is contiguous.
      std::sort(of.begin(), of.end(), [&](std::uint32_t a, std::uint32_t b) {
        return wide.nodes[a].begin < wide.nodes[b].begin;
      });
      below = of;
    }
    const auto count = static_cast<std::uint32_t>(below.size());
    const std::uint32_t parts = count <= most ? count : (count + most - 1) / most;
    node.first = static_cast<std::uint32_t>(rows.size()), node.count = parts;
    for (std::uint32_t k = 0; k < parts; ++k) {
      const std::size_t from = std::size_t{count} * k / parts,
                        to = std::size_t{count} * (k + 1) / parts;
      rows.push_back({below.subspan(from, to - from)});
    }
    result.nodes.push_back(node);
  }
  return result;
}

}  // namespace bvlab
