// SPDX-License-Identifier: BSD-3-Clause
/// Meshes from files, as they stand: nothing moved, scaled, merged, dropped or put in order.
///
/// OFF, OBJ, PLY, STL, DAE, 3MF and glTF 2.0 (also GLB) are read here, coordinates to the last
/// digit of float64, in UTF-8 or UTF-16 and with any ends of lines. Whatever else the installed
/// assimp knows (FBX, 3DS, glTF packed by Draco, ...; WRL only where it has a reader of that) is
/// read by assimp, whose coordinates are float32.
///
/// Applied are the transformations of a scene's nodes, in float64; its meshes follow each other in
/// the order of the nodes, parents first. Not applied are the unit and the axes that a file says
/// are up and right: its numbers are taken as they stand, in every format. Skins and morph targets
/// are not applied either: DAE and glTF whose nodes have them are refused.
///
/// Triangle i of a file of triangles is triangle i of the mesh, and vertices keep their numbers
/// (STL has none: there, three vertices a triangle). A polygon becomes triangles in its place
/// (polygon.hpp). Points and lines are left out; faces of fewer than three corners as well, which
/// is said. Open, self-intersecting and degenerate meshes are legal: triangles without area and
/// repeated ones stay. What a header promises is compared with the file before anything is read.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct ReadOptions {
  /// Coordinates are multiplied by it, for a file in another unit. Finite, above 0.
  double scale = 1;
  /// Gets what is to be said of the file, in one line that names it.
  std::function<void(const std::string&)> say = say_on_standard_error;
  /// Called where a signal arrives while a pipe is waited for; may throw.
  std::function<void()> on_signal = [] {};

  static void say_on_standard_error(const std::string& line);
};

/// The mesh in a file, its format told by the name's extension. Throws Unusable, with one line that
/// names the file, what is wrong and where, if the file is missing, truncated or no mesh, if it has
/// no triangle, an index out of range, or a coordinate that is NaN or infinite, or that is written
/// as a number too small to be told from 0.
TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from bytes in memory; `name` stands in for the file, in messages and for its extension.
TriangleMesh parse_mesh(std::string_view bytes, const std::string& name,
                        const ReadOptions& options = {});

/// A part of a file: a node of a scene (glTF, DAE, 3MF, ...) with all its meshes, an object or
/// group of an OBJ, a solid of an STL.
struct MeshPart {
  std::string name;                          ///< empty where the file has none
  std::shared_ptr<const TriangleMesh> mesh;  ///< in the part's frame; nodes alike share one
  /// The part's frame to that of the file. What a node's transformation has beside a rotation and a
  /// translation (scale, shear, mirroring) is in the mesh.
  Pose pose;
};

/// The parts of a file that have triangles, in its order; one where it has no parts. Posed and put
/// together they are the mesh of `read_mesh`, up to rounding (1e-6 for rotations written as
/// float32). Throws as `read_mesh` does.
std::vector<MeshPart> read_parts(const std::filesystem::path& path,
                                 const ReadOptions& options = {});
std::vector<MeshPart> parse_parts(std::string_view bytes, const std::string& name,
                                  const ReadOptions& options = {});

/// Says on standard error, in one line that names the mesh, that volumes will not tell its
/// triangles apart, for its largest coordinate is below 2^-50 or above 2^58
/// (hierarchies/exactness.md). Says nothing of other meshes, nor where there is nothing to tell
/// apart.
void say_if_nothing_is_culled(const TriangleMesh& mesh, const std::string& name);

/// Writes the mesh in OFF, whole or not at all, with as many digits as give the same float64 back.
void write_off(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace bvlab
