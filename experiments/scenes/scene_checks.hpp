// SPDX-License-Identifier: BSD-3-Clause
/// What assimp 5.2 reads as another mesh without a word, found in the file itself.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace bvlab {

/// Of a DAE, refuses lists that hold something else than their indices or numbers, or another count
/// of numbers than they promise: assimp does not go on, or makes 0 of what is missing. Of a glTF,
/// positions that are not float32, and extensions that move or pack vertices. Throws Unusable, with
/// the line where there are lines.
void require_what_assimp_reads(std::string_view bytes, const std::string& name);

/// How many triangles the nodes of a glTF's scene have by its counts: assimp leaves out those of
/// vertices that do not exist. Nothing of other formats.
std::optional<std::size_t> triangles_of_gltf(std::string_view bytes);

}  // namespace bvlab
