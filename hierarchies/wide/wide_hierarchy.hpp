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
#include "hierarchies/geometry/threads.hpp"
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

  /// A ball around the triangles of a node.
  struct alignas(16) Place {
    float middle[3];
    float radius;
  };

  WideHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit = Fit::published,
                std::uint32_t leaf_size = F, Threads&& threads = Threads())
      : WideHierarchy(mesh, binary, fit, leaf_size, threads) {}
  /// By several threads: the same, whatever their number.
  WideHierarchy(const TriangleMesh& mesh, const Topology& binary, Fit fit, std::uint32_t leaf_size,
                Threads& threads)
      : WideHierarchy(mesh, collapsed(mesh, binary, F, std::min<std::uint32_t>(leaf_size, F)), fit,
                      threads) {}

  /// A leaf holds at most F triangles.
  WideHierarchy(const TriangleMesh& mesh, const WideTopology& topology, Fit fit,
                Threads&& threads = Threads())
      : WideHierarchy(mesh, topology, fit, threads) {}
  WideHierarchy(const TriangleMesh& mesh, const WideTopology& topology, Fit fit, Threads& threads)
      : ball_(mesh), supports_(mesh, ball_.centre, threads) {
    nodes_.resize(topology.nodes.size());
    places_.resize(topology.nodes.size());
    siblings_.resize(topology.nodes.size());
    std::vector<Fitting> fitting(threads.count());
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (topology.nodes[i].leaf) leaves_.push_back(static_cast<std::uint32_t>(i));
    corners_.resize(leaves_.size());
    triangles_.resize(leaves_.size() * F);
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      const auto& node = topology.nodes[i];
      assert(node.count <= F);
      const V volume = fitted(mesh, topology, node.begin, node.end, fit, fitting[worker]);
      const auto lanes = static_cast<std::uint16_t>((1u << node.count) - 1);
      nodes_[i] = {volume, size_of(volume), node.first, lanes, node.leaf};
      places_[i] = place_of(fitting[worker].points);
    });
    threads.share_out(nodes_.size(), 8,
                      [&](std::size_t begin, std::size_t end, std::size_t worker) {
                        for (std::size_t i = begin; i < end; ++i)
                          put_children(i, mesh, topology, fit, fitting[worker]);
                      });
    threads.share(leaves_.size(), [&](std::size_t leaf, std::size_t) {
      keep_triangles(leaf, mesh, topology, topology.nodes[leaves_[leaf]]);
    });
    for (const Fitting& each : fitting) reach_ = std::max(reach_, each.reach);
    for (const auto& v : mesh.vertices) reach_ = std::max(reach_, stable_norm(v));
    reach_ *= 1 + 8 * unit_roundoff<scalar>;
  }

  std::size_t size() const { return nodes_.size(); }
  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  const Place& place(std::uint32_t i) const { return places_[i]; }
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
    return nodes_.size() * (sizeof(Node) + sizeof(Siblings) + sizeof(Place)) +
           corners_.size() * sizeof(TriangleLanes<scalar, F>) + triangles_.size() * 4 +
           supports_.bytes();
  }

 private:
  /// What a thread needs for itself while volumes are fitted.
  struct alignas(128) Fitting {
    std::vector<Vec3<double>> points;
    std::vector<Triangle> triangles;
    double reach = 0;
  };
  static V fitted(const TriangleMesh& mesh, const WideTopology& topology, std::uint32_t begin,
                  std::uint32_t end, Fit fit, Fitting& own) {
    own.points.clear(), own.triangles.clear();
    for (std::uint32_t place = begin; place < end; ++place) {
      own.triangles.push_back(mesh.corners(topology.primitives[place]));
      for (const auto& corner : own.triangles.back()) own.points.push_back(corner);
    }
    if constexpr (FittedTightly<V>)
      if (fit == Fit::tight) return V::tight(own.points, own.triangles);
    if constexpr (FittedToTriangles<V>)
      return V::enclosing(own.points, own.triangles);
    else
      return V::enclosing(own.points);
  }

  /// About the middle of their box.
  static Place place_of(const std::vector<Vec3<double>>& points) {
    Vec3<double> low = points[0], high = points[0];
    for (const auto& point : points)
      for (int i = 0; i < 3; ++i)
        low[i] = std::min(low[i], point[i]), high[i] = std::max(high[i], point[i]);
    Place place;
    Vec3<double> middle;
    for (int i = 0; i < 3; ++i) {
      place.middle[i] = static_cast<float>(0.5 * low[i] + 0.5 * high[i]);
      middle[i] = static_cast<double>(place.middle[i]);
    }
    double radius = 0;
    for (const auto& point : points) radius = std::max(radius, stable_norm(point - middle));
    place.radius = rounded_up<float>(radius * (1 + 16 * unit_roundoff<double>));
    return place;
  }

  /// All nodes have their volumes.
  void put_children(std::size_t i, const TriangleMesh& mesh, const WideTopology& topology, Fit fit,
                    Fitting& own) {
    const auto& node = topology.nodes[i];
    for (int lane = 0; lane < F; ++lane) {
      const std::uint32_t k = node.first + std::min<std::uint32_t>(lane, node.count - 1);
      const V volume = node.leaf ? fitted(mesh, topology, k, k + 1, fit, own) : nodes_[k].volume;
      put_lane(siblings_[i].volumes, lane, volume);
      siblings_[i].size[lane] = size_of(volume);
      own.reach = std::max(own.reach, static_cast<double>(reach_of(volume)));
    }
    own.reach = std::max(own.reach, static_cast<double>(reach_of(nodes_[i].volume)));
  }

  void keep_triangles(std::size_t leaf, const TriangleMesh& mesh, const WideTopology& topology,
                      const WideTopology::Node& node) {
    nodes_[leaves_[leaf]].first = static_cast<std::uint32_t>(leaf * F);
    for (int lane = 0; lane < F; ++lane) {
      const std::uint32_t place = node.first + std::min<std::uint32_t>(lane, node.count - 1);
      triangles_[leaf * F + static_cast<std::size_t>(lane)] = topology.primitives[place];
      const Triangle corners = mesh.corners(topology.primitives[place]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          corners_[leaf].corner[i][j][lane] = static_cast<scalar>(corners[i][j]);
    }
  }

  std::vector<Node> nodes_;
  std::vector<Place> places_;
  std::vector<Siblings> siblings_;
  std::vector<TriangleLanes<scalar, F>> corners_;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> leaves_;  // by what stands in corners_
  double reach_ = 0;
  MeshBall ball_;
  SupportMap supports_;
};

}  // namespace bvlab
