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
#include "hierarchies/relative_placement.hpp"
#include "hierarchies/tree.hpp"
#include "hierarchies/wide/collapse.hpp"

namespace bvlab {

template <BoundingVolume V>
class Hierarchy : public Tree {
 public:
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
      : Tree(topology), volumes_(topology.nodes.size()) {
    const LocalMesh local = about_own_origin(mesh);
    std::vector<Fitting<V>> fitting(threads.count());
    // The first nodes enclose the most triangles.
    threads.share(nodes_.size(), [&](std::size_t i, std::size_t worker) {
      enclose(i, begin_[i], end_[i], local.mesh(), fit, fitting[worker]);
    });
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (const Node& node = nodes_[i]; node.count == 0) take_smaller(i, around_children(node));
      nodes_[i].size = tree_size(volumes_[i]);
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
      nodes_[i].size = tree_size(volumes_[i]);
    }
    look_up();
    surround(local);
  }

  const V& volume(std::uint32_t node) const { return volumes_[node]; }
  const V* volumes() const { return volumes_.data(); }

 private:
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

  void enclose(std::size_t i, std::uint32_t begin, std::uint32_t end, const TriangleMesh& mesh,
               Fit fit, Fitting<V>& own) {
    own.take_vertices(mesh, std::span(primitives_).subspan(begin, end - begin));
    volumes_[i] = own.volume(fit);
    spheres_[i] = NodeSphere(own.points);
  }

  /// It decides an order alone: that of a volume over double is clipped to float.
  static float tree_size(const V& volume) {
    if constexpr (std::is_same_v<typename V::scalar, float>)
      return size_of(volume);
    else
      return static_cast<float>(
          std::min<typename V::scalar>(size_of(volume), std::numeric_limits<float>::max()));
  }

  void take_smaller(std::size_t i, const V& other) {
    // Written so that the other volume wins where this size is NaN.
    if (!(size_of(volumes_[i]) <= size_of(other))) volumes_[i] = other;
  }

  std::vector<V> volumes_;
};

}  // namespace bvlab
