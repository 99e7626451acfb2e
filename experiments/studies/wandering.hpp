// SPDX-License-Identifier: BSD-3-Clause
/// Bodies of one mesh wandering about, for studies: the parameters they share and what they make.
#pragma once

#include "experiments/scenes/trace.hpp"
#include "experiments/studies/study.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

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

  explicit Wandering(const StudyDefinition& definition);
  Scene scene(const std::string& name) const;
};

}  // namespace bvlab
