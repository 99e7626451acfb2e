// SPDX-License-Identifier: BSD-3-Clause
/// What assimp 5.2 reads as another mesh without a word, found in the file itself.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"

namespace bvlab {

/// Of a glTF, refuses positions that are not float32, extensions that move or pack vertices, skins
/// and morph targets, and nodes whose matrix or rotation is none. Throws Unusable.
void require_what_assimp_reads(std::string_view bytes, const std::string& name);

/// How many triangles the nodes of a glTF's scene have by its counts: assimp leaves out those of
/// vertices that do not exist. Nothing of other formats.
std::optional<std::size_t> triangles_of_gltf(std::string_view bytes);

/// What a glTF's nodes say of where they are in their parents, as written: parents first. assimp
/// rounds it to float32.
std::vector<SceneNode::Transformation> transformations_of_gltf(std::string_view bytes);

}  // namespace bvlab
