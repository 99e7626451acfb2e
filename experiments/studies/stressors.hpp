// SPDX-License-Identifier: BSD-3-Clause
/// THE list of stressors: pairs of meshes put where arithmetic is hard, and where the right answer
/// to "do they touch" hangs on the last digits. A case is a function of its stressor, level and
/// seed.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "experiments/scenes/trace.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Two objects, of two meshes.
struct StressCase {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};

struct Stressor {
  std::string_view name, description;
  std::span<const double> levels;  ///< what the level means is in the description
  StressCase (*make)(double level, std::size_t frames, std::uint64_t seed);
};

std::span<const Stressor> stressors();

/// Whether the surfaces share a point, frame by frame: every pair of triangles, for the vertices as
/// `Pose` moves them, in rational numbers.
std::vector<std::uint8_t> truth_of(const StressCase& stress);

/// All that says whether bodies touch, at every precision: every volume and strategy over binary
/// trees, posed into the world, and those over wide ones, in the other body's frame.
std::vector<Variant> stressed_variants();

}  // namespace bvlab
