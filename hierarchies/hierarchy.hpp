// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes over one mesh, flat: siblings adjacent, 32-bit indices, the volumes
/// in an array of their own because posing reads nothing else.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "hierarchies/geometry/written_out.hpp"
#include "hierarchies/hierarchy_extent.hpp"

namespace bvlab {

template <BoundingVolume V>
class Hierarchy {
 public:
  struct Node {
    std::uint32_t first;  ///< inner: the first of two adjacent children; leaf: of its primitives
    std::uint32_t count;  ///< number of primitives of a leaf; 0 for an inner node
    typename V::scalar size;  ///< of its volume: the larger one is descended
  };

  /// Fits V to a topology of the mesh, which must have a triangle. A parent takes the smaller of
  /// what encloses its two children and what encloses its triangles (quinlan1994efficient).
  /// O(n log n) for balanced trees.
  Hierarchy(const TriangleMesh& mesh, const Topology& topology, Fit fit = Fit::published,
            Threads&& threads = Threads())
      : Hierarchy(mesh, topology, fit, threads) {}
  /// By several threads, who share what encloses triangles: the same, whatever their number.
  Hierarchy(const TriangleMesh& mesh, const Topology& topology, Fit fit, Threads& threads)
      : primitives_(topology.primitives), volumes_(topology.nodes.size()) {
    nodes_.reserve(topology.nodes.size());
    for (const auto& [first, count] : topology.nodes) nodes_.push_back({first, count, 0});
    ranges_of(topology);
    std::vector<Fitting> fitting(threads.count());
    // The first enclose most.
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      enclose(i, begin_[i], end_[i], mesh, fit, fitting[worker]);
    });
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (const Node& node = nodes_[i]; node.count == 0)
        take_smaller(i, merge(volumes_[node.first], volumes_[node.first + 1]));
      nodes_[i].size = size_of(volumes_[i]);
    }
    look_up();
    surround(mesh);
    begin_.clear(), end_.clear();
  }

  /// Fits the volumes again to the same triangles, whose corners have moved: leaves by the
  /// published construction, parents around their children (vandenbergen1997efficient). O(n), and
  /// the looser the more the mesh has changed its shape. Bodies over it, and strategies that have
  /// run on them, are to be made anew.
  void refit(const TriangleMesh& mesh) {
    Fitting fitting;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (const Node& node = nodes_[i]; node.count > 0) {
        enclose(i, node.first, node.first + node.count, mesh, Fit::published, fitting);
      } else {
        volumes_[i] = merge(volumes_[node.first], volumes_[node.first + 1]);
      }
      nodes_[i].size = size_of(volumes_[i]);
    }
    look_up();
    surround(mesh);
  }

  std::size_t size() const { return nodes_.size(); }
  bool is_leaf(std::uint32_t node) const { return nodes_[node].count > 0; }
  const Node& node(std::uint32_t node) const { return nodes_[node]; }
  /// Of a node that is not the root.
  std::uint32_t parent(std::uint32_t node) const { return above_[(node + 1) / 2].parent; }
  /// The least size of all that the node lies below: of two nodes that make a pair, the parent of
  /// that for which this is less was descended last, of b where they are equal.
  typename V::scalar least_above(std::uint32_t node) const { return above_[(node + 1) / 2].least; }
  const V& volume(std::uint32_t node) const { return volumes_[node]; }
  /// The triangle that stands at a place in a leaf's range.
  std::uint32_t primitive(std::uint32_t place) const { return primitives_[place]; }
  std::size_t primitives() const { return primitives_.size(); }
  const HierarchyExtent& extent() const { return extent_; }

 private:
  struct Above {
    std::uint32_t parent;
    typename V::scalar least;  ///< size of the parent and all above it
  };

  /// Notes what is above each node, parents first.
  void look_up() {
    above_.assign(nodes_.size() / 2 + 1, {0, std::numeric_limits<typename V::scalar>::infinity()});
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
      if (const Node& node = nodes_[i]; node.count == 0)
        above_[(node.first + 1) / 2] = {i, std::min(above_[(i + 1) / 2].least, node.size)};
  }

  void surround(const TriangleMesh& mesh) {
    double reach = 0, radius = 0;
    for (const auto& v : volumes_) reach = std::max(reach, static_cast<double>(reach_of(v)));
    for (const auto& v : mesh.vertices) reach = std::max(reach, stable_norm(v));
    reach *= 1 + 8 * unit_roundoff<typename V::scalar>;
    Vec3<double> low = mesh.corners(0)[0], high = low;
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle)
        low = low.cwiseMin(mesh.vertices[v]), high = high.cwiseMax(mesh.vertices[v]);
    const Vec3<double> centre = low / 2 + high / 2;
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle)
        radius = std::max(radius, stable_norm(mesh.vertices[v] - centre));
    radius *= 1 + 16 * unit_roundoff<double>;
    extent_ = {centre, radius, reach, nodes_.size()};
  }

  /// The range of primitives below each node: children come after their parent, leaf by leaf.
  void ranges_of(const Topology& topology) {
    begin_.resize(nodes_.size()), end_.resize(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const auto& [first, count] = topology.nodes[i];
      begin_[i] = count ? first : std::min(begin_[first], begin_[first + 1]);
      end_[i] = count ? first + count : std::max(end_[first], end_[first + 1]);
    }
  }

  /// What a thread needs for itself while volumes are fitted.
  struct alignas(128) Fitting {
    std::vector<std::uint32_t> corners;
    std::vector<Vec3<double>> points;
    std::vector<Triangle> triangles;
  };
  void enclose(std::size_t i, std::uint32_t begin, std::uint32_t end, const TriangleMesh& mesh,
               Fit fit, Fitting& own) {
    auto& [corners, points, triangles] = own;
    corners.clear();
    for (std::uint32_t place = begin; place < end; ++place)
      for (const auto vertex : mesh.triangles[primitives_[place]]) corners.push_back(vertex);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    points.clear();
    for (const auto vertex : corners) points.push_back(mesh.vertices[vertex]);
    if constexpr (FittedToTriangles<V> || FittedTightly<V>) {
      triangles.clear();
      for (std::uint32_t place = begin; place < end; ++place)
        triangles.push_back(mesh.corners(primitives_[place]));
    }
    if constexpr (FittedTightly<V>) {
      if (fit == Fit::tight) {
        volumes_[i] = V::tight(points, triangles);
        return;
      }
    }
    if constexpr (FittedToTriangles<V>)
      volumes_[i] = V::enclosing(points, triangles);
    else
      volumes_[i] = V::enclosing(points);
  }

  void take_smaller(std::size_t i, const V& other) {
    // Written so that a size that is not a number loses.
    if (!(size_of(volumes_[i]) <= size_of(other))) volumes_[i] = other;
  }

  std::vector<std::uint32_t> primitives_;
  std::vector<Node> nodes_;
  std::vector<V> volumes_;
  std::vector<Above> above_;  // one for two siblings
  HierarchyExtent extent_;
  std::vector<std::uint32_t> begin_, end_;  // only while fitting
};

}  // namespace bvlab
