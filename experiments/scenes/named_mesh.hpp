// SPDX-License-Identifier: BSD-3-Clause
/// Meshes by name: those made by formula, and those that the set-up has unpacked from Debian's
/// libcgal-demo, simplified. `bunny` is there in any case: where its file is not, a bumpy sphere
/// stands in for it. `<name>-hull` is the convex hull of any of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct NamedMesh {
  std::string name;  ///< of what it is, which may be a stand-in for what was asked
  TriangleMesh mesh;
};

/// Where the set-up puts meshes: build/meshes of the source tree.
std::filesystem::path mesh_directory();

/// The mesh with about `polygons` triangles: a formula's, or `<name>.off` of `directory` (`bunny`
/// for bunny00.off), simplified and kept there as `<name>-<polygons>.off`, which is read the next
/// time. Throws Unusable with the names there are. Says on standard error when a stand-in is used.
NamedMesh named_mesh(const std::string& name, std::size_t polygons,
                     const std::filesystem::path& directory = mesh_directory());

/// Several meshes from one text: each a file (it holds a '/' or a '.'), `FILE:SCALE`, `NAME`,
/// `NAME:POLYGONS` or `NAME:POLYGONS:SCALE`, with commas between, and blanks around them as one
/// likes; `polygons` where none are given. Vertices are multiplied by the scale. A text that is a
/// file's name as it stands is that file, commas and all.
std::vector<NamedMesh> named_meshes(const std::string& list, std::size_t polygons);

/// Whether a file is among them, which has as many triangles as it has.
bool names_files(const std::string& list);

}  // namespace bvlab
