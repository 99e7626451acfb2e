// SPDX-License-Identifier: BSD-3-Clause
/// Meshes from files, as they stand: nothing moved, scaled, merged, dropped or put in order.
///
/// OFF, OBJ, PLY and STL are read here, coordinates to the last digit of float64. Whatever else
/// assimp knows (glTF, WRL, 3DS, DAE, ...) is read by assimp, whose coordinates are float32; the
/// nodes' transformations of such a scene are applied, in float64, and its meshes follow each other
/// in the order of the nodes, parents first.
///
/// Triangle i of a file of triangles is triangle i of the mesh, and vertices keep their numbers
/// (STL has none: there, three vertices a triangle). A polygon becomes triangles in its place, by
/// cutting ears; points and lines are left out. Open, self-intersecting and degenerate meshes are
/// legal: triangles without area and repeated ones stay.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The mesh in a file, its format told by the name's extension. Throws Unusable, with one line that
/// names the file, what is wrong and where, if the file is missing, truncated or no mesh, if it has
/// no triangle, an index out of range, or a coordinate that is NaN or infinite, or that is written
/// as a number too small to be told from 0.
TriangleMesh read_mesh(const std::filesystem::path& path);

/// The same from bytes in memory; `name` stands in for the file, in messages and for its extension.
TriangleMesh parse_mesh(std::string_view bytes, const std::string& name);

/// Says on standard error, in one line that names the mesh, that volumes will not tell its
/// triangles apart, for its largest coordinate is below 2^-50 or above 2^58
/// (hierarchies/exactness.md). Says nothing of other meshes, nor where there is nothing to tell
/// apart.
void say_if_nothing_is_culled(const TriangleMesh& mesh, const std::string& name);

/// Writes the mesh in OFF, whole or not at all, with as many digits as give the same float64 back.
void write_off(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace bvlab
