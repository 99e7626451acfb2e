// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes with up to F children a node. Siblings stand lane by lane in one
/// volume over batches, so that one volume is tested against all of them without a gather. Children
/// of a leaf are its triangles: they have volumes of their own, and corners lane by lane.
///
/// Nothing in it depends on where a body stands: bodies of one mesh share it.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <vector>

#include "hierarchies/geometry/enclosing_ball.hpp"
#include "hierarchies/geometry/written_out.hpp"
#include "hierarchies/hierarchy.hpp"
#include "hierarchies/wide/collapse.hpp"
#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/support_map.hpp"

namespace bvlab {

/// Corners of the triangles of a leaf, rounded: corner, coordinate, lane. Lanes beyond its
/// triangles repeat one.
template <class T, int F>
struct alignas(sizeof(T) * F) TriangleLanes {
  std::array<std::array<std::array<T, F>, 3>, 3> corner;
};

/// A ball around a mesh, in its frame.
struct MeshBall {
  Vec3<double> centre = Vec3<double>::Zero();
  double radius = 0;

  MeshBall() = default;
  explicit MeshBall(const TriangleMesh& mesh) {
    std::vector<Vec3<double>> corners;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const auto& corner : mesh.corners(i)) corners.push_back(corner);
    centre = enclosing_ball(corners).centre;
    for (const auto& corner : corners) radius = std::max(radius, stable_norm(corner - centre));
    radius *= 1 + 16 * unit_roundoff<double>;
  }
};

template <BoundingVolume V, int F>
class WideHierarchy {
  static_assert(F == 2 || F == 4 || F == 8 || F == 16);

 public:
  using scalar = typename V::scalar;
  using Lane = Batch<scalar, F>;
  static constexpr int fan_out = F;

  /// What is asked of a node before it is tested or opened.
  struct alignas(32) Node {
    V volume;
    scalar size;
    std::uint32_t first;  ///< of its children; leaf: of its triangles, as triangle(lane) counts
    std::uint16_t lanes;  ///< which of its lanes hold a child
    std::uint16_t leaf;   ///< 0 or 1
  };

  /// Its children.
  struct Siblings {
    Over<V, Lane> volumes;
    Lane size;
  };

  WideHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit = Fit::published,
                std::uint32_t leaf_size = F)
      : WideHierarchy(mesh, collapsed(mesh, binary, F, std::min<std::uint32_t>(leaf_size, F)),
                      fit) {}

  /// A leaf holds at most F triangles.
  WideHierarchy(const TriangleMesh& mesh, const WideTopology& topology, Fit fit)
      : ball_(mesh), supports_(mesh, ball_.centre) {
    nodes_.reserve(topology.nodes.size());
    siblings_.resize(topology.nodes.size());
    for (const auto& node : topology.nodes) {
      assert(node.count <= F);
      const V volume = fitted(mesh, topology, node.begin, node.end, fit);
      const auto lanes = static_cast<std::uint16_t>((1u << node.count) - 1);
      nodes_.push_back({volume, size_of(volume), node.first, lanes, node.leaf});
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto& node = topology.nodes[i];
      if (node.leaf) {
        keep_triangles(nodes_[i], mesh, topology, node);
        leaves_.push_back(static_cast<std::uint32_t>(i));
      }
      for (int lane = 0; lane < F; ++lane) {
        const std::uint32_t k = node.first + std::min<std::uint32_t>(lane, node.count - 1);
        const V volume = node.leaf ? fitted(mesh, topology, k, k + 1, fit) : nodes_[k].volume;
        put_lane(siblings_[i].volumes, lane, volume);
        siblings_[i].size[lane] = size_of(volume);
        reach_ = std::max(reach_, static_cast<double>(reach_of(volume)));
      }
      reach_ = std::max(reach_, static_cast<double>(reach_of(nodes_[i].volume)));
    }
    for (const auto& v : mesh.vertices) reach_ = std::max(reach_, stable_norm(v));
    reach_ *= 1 + 8 * unit_roundoff<scalar>;
  }

  std::size_t size() const { return nodes_.size(); }
  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  const Siblings& children(std::uint32_t i) const { return siblings_[i]; }
  /// Leaf `first / F`'s, of a node of that `first`.
  const TriangleLanes<scalar, F>& corners(std::uint32_t first) const { return corners_[first / F]; }
  /// The leaf that holds triangle k.
  std::uint32_t leaf_of(std::uint32_t k) const { return leaves_[k / F]; }
  /// The mesh's index of the triangle in lane `k - first` of a leaf.
  std::uint32_t triangle(std::uint32_t k) const { return triangles_[k]; }
  /// No vertex is farther than this from the mesh's own origin, and no volume extends beyond.
  double reach() const { return reach_; }

  const MeshBall& ball() const { return ball_; }
  /// About the ball's centre.
  const SupportMap& supports() const { return supports_; }

  std::size_t bytes() const {
    return nodes_.size() * (sizeof(Node) + sizeof(Siblings)) +
           corners_.size() * sizeof(TriangleLanes<scalar, F>) + triangles_.size() * 4 +
           supports_.bytes();
  }

 private:
  V fitted(const TriangleMesh& mesh, const WideTopology& topology, std::uint32_t begin,
           std::uint32_t end, Fit fit) {
    points_.clear(), fitted_.clear();
    for (std::uint32_t place = begin; place < end; ++place) {
      fitted_.push_back(mesh.corners(topology.primitives[place]));
      for (const auto& corner : fitted_.back()) points_.push_back(corner);
    }
    if constexpr (FittedTightly<V>)
      if (fit == Fit::tight) return V::tight(points_, fitted_);
    if constexpr (FittedToTriangles<V>)
      return V::enclosing(points_, fitted_);
    else
      return V::enclosing(points_);
  }

  void keep_triangles(Node& node, const TriangleMesh& mesh, const WideTopology& topology,
                      const WideTopology::Node& leaf) {
    node.first = static_cast<std::uint32_t>(triangles_.size());
    corners_.emplace_back();
    for (int lane = 0; lane < F; ++lane) {
      const std::uint32_t place = leaf.first + std::min<std::uint32_t>(lane, leaf.count - 1);
      triangles_.push_back(topology.primitives[place]);
      const Triangle corners = mesh.corners(triangles_.back());
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          corners_.back().corner[i][j][lane] = static_cast<scalar>(corners[i][j]);
    }
  }

  std::vector<Node> nodes_;
  std::vector<Siblings> siblings_;
  std::vector<TriangleLanes<scalar, F>> corners_;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> leaves_;  // by what stands in corners_
  double reach_ = 0;
  MeshBall ball_;
  SupportMap supports_;
  // Only while fitting:
  std::vector<Vec3<double>> points_;
  std::vector<Triangle> fitted_;
};

}  // namespace bvlab
