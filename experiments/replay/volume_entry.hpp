// SPDX-License-Identifier: BSD-3-Clause
/// A volume of the list as the program sees it while it runs: a name, and functions that were
/// compiled for it by themselves.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/build/topology.hpp"

namespace bvlab {

/// Hierarchies of some volume, one for each mesh; the meshes must outlive them.
class AnyHierarchies {
 public:
  virtual ~AnyHierarchies() = default;
  virtual std::size_t meshes() const = 0;
  virtual const TriangleMesh& mesh(std::size_t i) const = 0;
};

/// A point that is asked how far it is from a node's triangles, by the node's volume.
struct GapQuestion {
  std::uint32_t node;
  Vec3<double> point;
};

struct VolumeEntry {
  std::string_view name, description;
  bool has_tight_fit, has_body_frame;
  std::unique_ptr<AnyHierarchies> (*hierarchies)(std::span<const TriangleMesh>, const Variant&);
  /// The gap between each node's volume and the volume around each point, both at rest.
  std::vector<double> (*gaps)(const TriangleMesh&, const Topology&, Fit,
                              std::span<const GapQuestion>);
  std::string_view drawn_as;  ///< see drawn_volume.hpp
  /// Of these nodes of one mesh's hierarchy, one after the other; hierarchies are of this volume.
  std::vector<float> (*drawn)(const AnyHierarchies&, std::size_t mesh,
                              std::span<const std::uint32_t> nodes);
};

}  // namespace bvlab
