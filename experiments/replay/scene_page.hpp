// SPDX-License-Identifier: BSD-3-Clause
/// A replay as a page: one HTML file that needs no other and no network, in which the bodies move,
/// with what it cost beneath them.
///
/// What is written stays below ten megabytes whatever the trace: of more, frames, levels of the
/// hierarchies, triangles and fronts are left out, and the page says which.
#pragma once

#include <span>
#include <string>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct SceneNames {
  std::span<const std::string> meshes;  ///< one for each mesh
  std::string trace;
};

/// Plays the trace, counted, and once more where the strategy keeps fronts. Throws Unusable where
/// the page's own files are missing.
std::string scene_page(std::span<const TriangleMesh> meshes, const Trace& trace,
                       const Variant& variant, const SceneNames& names);

}  // namespace bvlab
