// SPDX-License-Identifier: BSD-3-Clause
/// The formats that `read_mesh` knows: one parser each. All throw Unusable, as `read_mesh` says; a
/// mesh without triangles is for it to refuse.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "experiments/scenes/read_mesh.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// What is to be said of a file, if anything.
class Note {
 public:
  /// A face that makes no triangle; `where` says which.
  void leave_out(const std::string& where) {
    if (left_out_++ == 0) first_left_out_ = where;
  }
  void say(const std::string& what) {
    if (said_.find(what) == said_.npos) said_ += (said_.empty() ? "" : "; ") + what;
  }
  std::string text() const {
    if (left_out_ == 0) return said_;
    return (said_.empty() ? "" : said_ + "; ") + first_left_out_ +
           ": a face of fewer than three corners is left out" +
           (left_out_ > 1 ? " (" + std::to_string(left_out_) + " in all)" : "") +
           "; triangles are numbered without it";
  }

 private:
  std::string said_, first_left_out_;
  std::size_t left_out_ = 0;
};

/// What is wrong with a reference to a vertex, by its number or its digits.
template <class Number>
std::string no_vertex(const Number& number, std::size_t vertices) {
  std::string shown;
  if constexpr (std::is_arithmetic_v<Number>)
    shown = std::to_string(number);
  else
    shown = number;
  return "vertex " + shown + " does not exist: there are " + std::to_string(vertices) + ", from 0";
}

/// What a file holds.
struct ParsedMesh {
  /// Triangles from `first` on, up to the next part's, bear the name.
  struct Part {
    std::string name;
    std::size_t first;
  };

  TriangleMesh mesh;
  std::vector<Part> parts;  ///< in order of `first`; none where the file has no names
  Note note;
};

/// OFF, COFF, NOFF, CNOFF, STOFF ...: text, three coordinates a vertex, one vertex or face a line.
ParsedMesh parse_off(std::string_view bytes, const std::string& name);
/// Wavefront: `v`, `f`, `o` and `g`; attributes, points, lines and free forms are passed over.
ParsedMesh parse_obj(std::string_view bytes, const std::string& name);
/// PLY, text and binary: elements `vertex` (x, y, z), `face` and `tristrips` (vertex_indices or
/// vertex_index).
ParsedMesh parse_ply(std::string_view bytes, const std::string& name);
/// STL, text and binary.
ParsedMesh parse_stl(std::string_view bytes, const std::string& name);

struct MeshFormat {
  std::string_view extension;
  ParsedMesh (*parse)(std::string_view bytes, const std::string& name);
};
inline constexpr MeshFormat own_formats[] = {
    {".off", parse_off}, {".obj", parse_obj}, {".ply", parse_ply}, {".stl", parse_stl}};

/// A node of a scene, with all its meshes.
struct SceneNode {
  using Transformation = Eigen::Matrix<double, 3, 4>;

  std::string name;
  std::vector<unsigned> meshes;  ///< their numbers in the scene
  Transformation to_world;
};

/// The child's transformation first, then the parent's.
inline SceneNode::Transformation product(const SceneNode::Transformation& parent,
                                         const SceneNode::Transformation& child) {
  SceneNode::Transformation t = parent.leftCols<3>() * child;
  t.col(3) += parent.col(3);
  return t;
}

/// A scene: nodes with meshes, parents first.
struct SceneGraph {
  std::vector<SceneNode> nodes;
  std::vector<TriangleMesh> meshes;  ///< in their nodes' frames; those that no node has are empty
  std::string note;                  ///< what is to be said of it, if anything

  /// All nodes in the world's frame, one after the other. Throws Unusable.
  TriangleMesh joined(const std::string& name) const;
  /// Appends a node's meshes, transformed by `to`.
  void append(TriangleMesh& result, const SceneNode& node, const SceneNode::Transformation& to,
              const std::string& name) const;
};

/// COLLADA (DAE): its scene's nodes, triangles and polygons.
SceneGraph parse_dae(std::string_view bytes, const std::string& name);
/// 3MF: what its build list has.
SceneGraph parse_3mf(std::string_view bytes, const std::string& name);

/// What assimp adds at the root to turn a file's axes and unit into its own.
enum class Conversion { none, of_assimp };

/// glTF 2.0 (text and GLB): its scene's nodes and triangles. Of a `file`, others beside it are
/// read. Nothing where it is of version 1 or packed by Draco, which assimp reads.
std::optional<SceneGraph> parse_gltf(std::string_view bytes, const std::string& name,
                                     const std::filesystem::path& file);

/// By assimp, from a file of these bytes (which may refer to others beside it) and from memory. It
/// runs in a process of its own (experiments/files/guarded.hpp).
SceneGraph read_with_assimp(const std::filesystem::path& path, std::string_view bytes);
SceneGraph parse_with_assimp(std::string_view bytes, const std::string& name,
                             Conversion conversion = Conversion::none);

/// The parser of a file of that name; nullptr where it is one of scenes.
const MeshFormat* own_format(const std::string& name);
/// By that parser; says what there is to be said.
ParsedMesh parsed_mesh(std::string_view bytes, const std::string& name, const MeshFormat& format,
                       const ReadOptions& options);
/// The scene in these bytes: by a parser of ours, or by assimp; of a `file`, others beside it may
/// be read. Says what there is to be said.
SceneGraph parsed_scene(std::string_view bytes, const std::string& name, const ReadOptions& options,
                        const std::filesystem::path& file = {});
/// The bytes of a file, of which there are some. Checks the options, too.
std::string bytes_of(const std::filesystem::path& path, const ReadOptions& options);
/// The mesh multiplied by the options' scale.
TriangleMesh scaled_mesh(TriangleMesh mesh, const std::string& name, const ReadOptions& options);

}  // namespace bvlab
