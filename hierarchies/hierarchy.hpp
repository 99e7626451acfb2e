// SPDX-License-Identifier: BSD-3-Clause
/// A tree of bounding volumes over one mesh, binary or with up to sixteen children per node, stored
/// flat: siblings are adjacent, indices are 32 bits, and volumes are in an array of their own,
/// since posing reads nothing else. They are about an origin of the mesh's own (LocalMesh).
///
/// The fan-out belongs to the topology, not to the type: code compiled for a volume runs on trees
/// of every fan-out.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/build/topology.hpp"
#include "hierarchies/fitting.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/small_matrices.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "hierarchies/hierarchy_extent.hpp"
#include "hierarchies/node_sphere.hpp"
#include "hierarchies/relative_placement.hpp"
#include "hierarchies/wide/collapse.hpp"

namespace bvlab {

template <BoundingVolume V>
class Hierarchy {
 public:
  struct Node {
    std::uint32_t first;      ///< inner: the first of adjacent children; leaf: of its primitives
    std::uint32_t count;      ///< number of primitives of a leaf; 0 for an inner node
    std::uint32_t children;   ///< number of children, 2 to 16; 0 for a leaf
    std::uint32_t group;      ///< the index of the children's group, see group()
    typename V::scalar size;  ///< of its volume: the larger of a pair is descended
  };

  /// Fits V to a topology (a binary Topology or a WideTopology) of the mesh, which must have at
  /// least one triangle. A parent takes the smaller of two volumes: around its children, or around
  /// its triangles (quinlan1994efficient). O(n log n) for balanced trees.
  template <class AnyTopology>
  Hierarchy(const TriangleMesh& mesh, const AnyTopology& topology, Fit fit = Fit::published,
            Threads&& threads = Threads())
      : Hierarchy(mesh, topology, fit, threads) {}
  /// The same on several threads, which share the fitting to triangles. The result does not depend
  /// on their number.
  template <class AnyTopology>
  Hierarchy(const TriangleMesh& mesh, const AnyTopology& topology, Fit fit, Threads& threads)
      : primitives_(topology.primitives),
        volumes_(topology.nodes.size()),
        spheres_(topology.nodes.size()) {
    take_nodes(topology);
    number_siblings();
    const LocalMesh local = about_own_origin(mesh);
    std::vector<Fitting<V>> fitting(threads.count());
    // The first nodes enclose the most triangles.
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      enclose(i, begin_[i], end_[i], local.mesh(), fit, fitting[worker]);
    });
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (const Node& node = nodes_[i]; node.count == 0) take_smaller(i, around_children(node));
      nodes_[i].size = size_of(volumes_[i]);
    }
    look_up();
    surround(local);
    begin_.clear(), end_.clear();
  }

  /// Refits the volumes to the same triangles after vertices have moved: leaves by the published
  /// construction, parents around their children (vandenbergen1997efficient). O(n). The more the
  /// mesh has changed its shape, the looser the volumes. Bodies over the hierarchy, and strategies
  /// that have run on them, must be constructed anew.
  void refit(const TriangleMesh& mesh) {
    const LocalMesh local = about_own_origin(mesh);
    Fitting<V> fitting;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (const Node& node = nodes_[i]; node.count > 0) {
        enclose(i, node.first, node.first + node.count, local.mesh(), Fit::published, fitting);
      } else {
        volumes_[i] = around_children(node);
        spheres_[i] =
            NodeSphere(std::span<const NodeSphere>(spheres_).subspan(node.first, node.children));
      }
      nodes_[i].size = size_of(volumes_[i]);
    }
    look_up();
    surround(local);
  }

  std::size_t size() const { return nodes_.size(); }
  bool is_leaf(std::uint32_t node) const { return nodes_[node].count > 0; }
  const Node& node(std::uint32_t node) const { return nodes_[node]; }
  /// The largest number of children of a node, at least 2.
  std::uint32_t fan_out() const { return fan_out_; }
  /// The index of a node's group of siblings, below `sibling_groups()`; the root's is 0.
  std::uint32_t group(std::uint32_t node) const { return SiblingGroups(*this)(node); }
  /// The same as a function object, for use in loops; valid as long as the hierarchy.
  class SiblingGroups {
   public:
    explicit SiblingGroups(const Hierarchy& hierarchy)
        : groups_(hierarchy.groups_.empty() ? nullptr : hierarchy.groups_.data()) {}
    std::uint32_t operator()(std::uint32_t node) const {
      return groups_ ? groups_[node] : (node + 1) / 2;
    }

   private:
    const std::uint32_t* groups_;
  };
  std::size_t sibling_groups() const { return above_.size(); }
  /// What siblings have in common.
  struct Above {
    std::uint32_t parent;
    std::uint32_t first, count;  ///< the siblings
    /// The smallest size among the parent and its ancestors. In a pair of nodes, the one for which
    /// this is smaller has the parent that was descended last; node b where they are equal.
    typename V::scalar least;
  };
  const Above& above(std::uint32_t node) const { return above_[group(node)]; }
  const Above& above_group(std::uint32_t group) const { return above_[group]; }
  const V& volume(std::uint32_t node) const { return volumes_[node]; }
  const V* volumes() const { return volumes_.data(); }
  /// A sphere around the triangles below each node.
  const NodeSphere* node_spheres() const { return spheres_.data(); }
  /// The mesh's triangle at an index in a leaf's range of primitives.
  std::uint32_t primitive(std::uint32_t index) const { return primitives_[index]; }
  std::size_t primitives() const { return primitives_.size(); }
  const HierarchyExtent& extent() const { return extent_; }

 private:
  void take_nodes(const Topology& topology) {
    nodes_.reserve(topology.nodes.size());
    for (const auto& [first, count] : topology.nodes)
      nodes_.push_back({first, count, count ? 0u : 2u, 0, 0});
    ranges_of(topology);
  }
  void take_nodes(const WideTopology& topology) {
    for (const auto& node : topology.nodes) {
      assert(node.leaf || (node.count >= 2 && node.count <= 16));
      nodes_.push_back({node.first, node.leaf ? node.count : 0, node.leaf ? 0 : node.count, 0, 0});
      begin_.push_back(node.begin), end_.push_back(node.end);
      if (!node.leaf) fan_out_ = std::max(fan_out_, node.count);
    }
  }

  /// Numbers the groups of siblings. In a binary tree siblings are nodes 2k - 1 and 2k.
  void number_siblings() {
    std::uint32_t groups = 1;
    bool binary = true;
    for (const Node& node : nodes_)
      if (node.children > 0) ++groups, binary = binary && node.children == 2 && node.first % 2 == 1;
    above_.resize(groups);
    if (!binary) groups_.assign(nodes_.size(), 0);
    groups = 0;
    for (Node& node : nodes_)
      if (node.children > 0) {
        node.group = binary ? (node.first + 1) / 2 : ++groups;
        if (!binary) std::fill_n(groups_.begin() + node.first, node.children, node.group);
      }
  }

  /// Computes `above_`, parents first.
  void look_up() {
    above_[0] = {0, 0, 1, std::numeric_limits<typename V::scalar>::infinity()};
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
      if (const Node& node = nodes_[i]; node.count == 0)
        above_[node.group] = {i, node.first, node.children,
                              std::min(above_[group(i)].least, node.size)};
  }

  V around_children(const Node& node) const {
    V around = merge(volumes_[node.first], volumes_[node.first + 1]);
    for (std::uint32_t k = 2; k < node.children; ++k)
      around = merge(around, volumes_[node.first + k]);
    return around;
  }

  /// Placements that take no error bound know nothing of origins.
  static LocalMesh about_own_origin(const TriangleMesh& mesh) {
    return PlacedRelatively<V> ? LocalMesh(mesh) : LocalMesh::as_given(mesh);
  }

  void surround(const LocalMesh& local) {
    const TriangleMesh& mesh = local.mesh();
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
    const auto leaves = std::count_if(nodes_.begin(), nodes_.end(),
                                      [](const Node& node) { return node.count > 0; });
    extent_ = {centre, radius, reach, nodes_.size(), static_cast<std::size_t>(leaves),
               local.origin()};
  }

  /// The range of primitives below each node. Children come after their parent in the topology.
  void ranges_of(const Topology& topology) {
    begin_.resize(nodes_.size()), end_.resize(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const auto& [first, count] = topology.nodes[i];
      begin_[i] = count ? first : std::min(begin_[first], begin_[first + 1]);
      end_[i] = count ? first + count : std::max(end_[first], end_[first + 1]);
    }
  }

  void enclose(std::size_t i, std::uint32_t begin, std::uint32_t end, const TriangleMesh& mesh,
               Fit fit, Fitting<V>& own) {
    own.take_vertices(mesh, std::span(primitives_).subspan(begin, end - begin));
    volumes_[i] = own.volume(fit);
    spheres_[i] = NodeSphere(own.points);
  }

  void take_smaller(std::size_t i, const V& other) {
    // Written so that the other volume wins where this size is NaN.
    if (!(size_of(volumes_[i]) <= size_of(other))) volumes_[i] = other;
  }

  std::vector<std::uint32_t> primitives_;
  std::vector<Node> nodes_;
  std::vector<V> volumes_;
  std::vector<NodeSphere> spheres_;
  std::vector<Above> above_;           // one for each group of siblings
  std::vector<std::uint32_t> groups_;  // of each node; empty in a binary tree
  std::uint32_t fan_out_ = 2;
  HierarchyExtent extent_;
  std::vector<std::uint32_t> begin_, end_;  // only while fitting
};

}  // namespace bvlab
