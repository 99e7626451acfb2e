// SPDX-License-Identifier: BSD-3-Clause
/// Bodies of one mesh wandering about, for studies: the parameters they share and what they make.
#pragma once

#include "experiments/scenes/trace.hpp"
#include "experiments/studies/study.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Those of Wandering but `side`, behind others.
StudyParameters with_wandering(StudyParameters others);
/// With `side` of all scenes.
StudyParameters with_wandering_and_side(StudyParameters others);

inline constexpr NumberBounds lengths{0, 1e6}, sides_of_cubes{1e-6, 1e6};

struct Wandering {
  std::vector<std::string> names;  ///< of meshes, or NAME:POLYGONS: one scene for each
  std::size_t polygons, objects, frames;
  std::uint64_t seed;
  double side, step, degrees;  ///< lengths in radii of the body

  struct Scene {
    std::vector<TriangleMesh> meshes;
    Trace trace;
    double radius;  ///< of the mesh
  };

  /// Of a kind of study that has their parameters.
  explicit Wandering(const StudyDefinition& definition, double side);
  Scene scene(const std::string& name) const;
};

}  // namespace bvlab
