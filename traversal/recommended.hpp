// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for the queries touching and contacts, where triangles are about
/// as long as wide, as in scans and simulations: slab-boxes (slab_box.hpp) in wide trees that are
/// made on demand, as many children per node as a register has lanes, tested in the bodies' own
/// frames, with margins from frame to frame. recommended_for.hpp has others and chooses, as `bvlab
/// replay --recommended` does. For distances see recommended_distances.hpp.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "hierarchies/builds.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

/// How elongated triangles are, weighted by size: the sum of the squares of longest edges over
/// twice the total area. The value is 1.15 where all are equilateral, 2.7 for a scanned bunny, and
/// 4 and more for models of plates and beams. There boxes along a mesh's own axes are mostly empty,
/// and oriented boxes, with the kernel `mixed`, take a third to a twentieth of the time. Returns
/// the largest value of all meshes; infinity if one has no area. O(triangles).
inline double elongation(std::span<const TriangleMesh> meshes) {
  double most = 0;
  for (const auto& mesh : meshes) {
    double squares = 0, doubled_area = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.corners(i);
      squares += std::max(
          {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
      doubled_area += (t[1] - t[0]).cross(t[2] - t[0]).norm();
    }
    most = std::max(
        most, doubled_area > 0 ? squares / doubled_area : std::numeric_limits<double>::infinity());
  }
  return most;
}
/// The elongation above which triangles count as long.
inline constexpr double long_triangles = 3.5;

/// Wide trees of one volume. Build is an entry of builds.hpp; at most `leaf_size` triangles per
/// leaf.
template <BoundingVolume V, int F, class KernelType, class BuildType, Fit kFit,
          std::uint32_t kLeafSize>
struct WideTrees {
  using Volume = V;
  using Kernel = KernelType;
  using Build = BuildType;
  static constexpr int fan_out = F;
  static constexpr Fit fit = kFit;
  static constexpr std::uint32_t leaf_size = kLeafSize;
  using Hierarchy = typename Kernel::template Hierarchy<Volume, fan_out>;
  using Shape = WideShape<Volume, fan_out, Kernel>;

  /// The hierarchy of a mesh. One serves all bodies of that mesh.
  static Hierarchy hierarchy(const TriangleMesh& mesh, [[maybe_unused]] int threads = 1) {
    if constexpr (std::is_same_v<Build, builds::OnDemand>) {
      return Hierarchy::on_demand(mesh, leaf_size);
    } else {
      Threads several(threads);
      return Hierarchy(mesh, Build::topology(mesh, 1, several), fit, leaf_size, several);
    }
  }
};

/// A configuration: these trees, and what pairs keep from frame to frame. NoMemory is recursion
/// from the roots.
template <class TreesType, class MemoryType>
struct WideConfiguration : TreesType {
  using Trees = TreesType;
  using Memory = MemoryType;
  using Pairs = WidePairs<typename Trees::Volume, Trees::fan_out, Memory, typename Trees::Kernel>;
};
template <class Trees>
using MarginsOver = WideConfiguration<Trees, WideMargins>;
template <class Trees>
using RootsOf = WideConfiguration<Trees, NoMemory>;

/// Trees are made on demand: a node when a traversal first opens it. Meshes must outlive
/// hierarchies.
using Recommended = MarginsOver<WideTrees<SlabBox<float>, native_fan_out<float>, SiblingsKernel,
                                          builds::OnDemand, Fit::published, native_fan_out<float>>>;

}  // namespace bvlab
