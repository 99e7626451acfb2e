// SPDX-License-Identifier: BSD-3-Clause
/// The formats that `read_mesh` knows: one parser each. All throw Unusable, as `read_mesh` says; a
/// mesh without triangles is for it to refuse.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// OFF, COFF, NOFF, CNOFF, STOFF ...: text, three coordinates a vertex, one vertex or face a line.
TriangleMesh parse_off(std::string_view bytes, const std::string& name);
/// Wavefront: `v` and `f`; all else is passed over.
TriangleMesh parse_obj(std::string_view bytes, const std::string& name);

/// PLY, text and binary: elements `vertex` (x, y, z) and `face` (vertex_indices or vertex_index).
TriangleMesh parse_ply(std::string_view bytes, const std::string& name);
/// STL, text and binary.
TriangleMesh parse_stl(std::string_view bytes, const std::string& name);

struct MeshFormat {
  std::string_view extension;
  TriangleMesh (*parse)(std::string_view bytes, const std::string& name);
};
inline constexpr MeshFormat own_formats[] = {
    {".off", parse_off}, {".obj", parse_obj}, {".ply", parse_ply}, {".stl", parse_stl}};

/// By assimp, from a file (which may refer to others beside it) and from memory.
TriangleMesh read_with_assimp(const std::filesystem::path& path);
TriangleMesh parse_with_assimp(std::string_view bytes, const std::string& name,
                               const std::string& extension);

}  // namespace bvlab
