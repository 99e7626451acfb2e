// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <csignal>
#include <cstring>

#include "experiments/files/guarded.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_encoding.hpp"

namespace bvlab {
namespace {

using Transformation = SceneNode::Transformation;

const Transformation identity = Transformation::Identity();

Transformation transformation_of(const aiNode& node) {
  const aiMatrix4x4& m = node.mTransformation;
  Transformation t;
  t << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4;
  return t;
}

Vec3<double> image(const Transformation& t, const Vec3<double>& v) {
  return t == identity ? v : Vec3<double>(t.leftCols<3>() * v + t.col(3));
}

/// What the scene's root would be if nothing had been added to it for the file's axes and unit.
Transformation own_root(const Transformation& root, std::string_view importer) {
  // All that their roots have is what was added.
  for (const std::string_view name :
       {"Discreet 3DS", "Autodesk FBX", "Drawing Interchange Format", "ASE ", "Cinema4D",
        "Inter-Quake", "Quake", "Doom 3", "Return To Castle Wolfenstein"})
    if (importer.starts_with(name)) return identity;
  if (!importer.starts_with("Industry Foundation Classes")) return root;
  // Metres, and a quarter of a turn about x, before the file's own placement.
  Mat3<double> turn;
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const double unit = std::cbrt(root.leftCols<3>().determinant());
  return unit > 0 ? Transformation(turn * root / unit) : root;
}

class Gatherer {
 public:
  Gatherer(const aiScene& scene, const std::string& name) : scene_(scene), name_(name) {
    result_.meshes.resize(scene.mNumMeshes);
  }

  SceneGraph gathered(const Transformation& root) {
    if (scene_.mRootNode) visit(*scene_.mRootNode, root, 0);
    return std::move(result_);
  }

 private:
  void visit(const aiNode& node, const Transformation& here, int depth) {
    if (depth > 1000) throw Unusable(name_, "nodes more than 1000 deep");
    SceneNode found{node.mName.C_Str(), {}, here};
    if (found.name.starts_with("nodes[")) found.name.clear();  // given by assimp's reader of glTF
    for (unsigned i = 0; node.mMeshes && i < node.mNumMeshes; ++i) {
      const unsigned number = node.mMeshes[i];
      if (number >= scene_.mNumMeshes)
        throw Unusable(
            name_, "node '" + found.name + "': mesh " + std::to_string(number) + " does not exist");
      const aiMesh* mesh = scene_.mMeshes[number];
      // Some of assimp's readers leave arrays out where they found nothing to put in.
      if (!mesh || !mesh->mVertices || !mesh->mFaces) continue;
      if (result_.meshes[number].vertices.empty()) take(*mesh, number);
      found.meshes.push_back(number);
    }
    if (!found.meshes.empty()) result_.nodes.push_back(std::move(found));
    for (unsigned i = 0; i < node.mNumChildren; ++i)
      if (const aiNode* child = node.mChildren[i])
        visit(*child, product(here, transformation_of(*child)), depth + 1);
  }

  void take(const aiMesh& mesh, unsigned number) {
    const auto fault = [&](const std::string& what) {
      throw Unusable(name_, "mesh " + std::to_string(number) + ": " + what);
    };
    TriangleMesh& result = result_.meshes[number];
    result.vertices.reserve(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        fault("vertex " + std::to_string(i) + " is not finite");
      result.vertices.push_back({v.x, v.y, v.z});
    }
    std::vector<std::uint32_t> corners;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      corners.clear();
      for (unsigned k = 0; face.mIndices && k < face.mNumIndices; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices)
          fault("face " + std::to_string(i) + ": vertex " + std::to_string(face.mIndices[k]) +
                " does not exist: there are " + std::to_string(mesh.mNumVertices));
        corners.push_back(face.mIndices[k]);
      }
      append_polygon(result, corners);
    }
  }

  const aiScene& scene_;
  const std::string& name_;
  SceneGraph result_;
};

SceneGraph gathered(const Assimp::Importer& importer, const aiScene* scene, const std::string& name,
                    Conversion conversion) {
  if (!scene) {
    std::string why = importer.GetErrorString();
    why = why.substr(0, why.find('\n'));
    throw Unusable(name,
                   "not a mesh that assimp reads: " + (why.empty() ? "no reason given" : why));
  }
  Transformation root = scene->mRootNode ? transformation_of(*scene->mRootNode) : identity;
  const int index = importer.GetPropertyInteger("importerIndex", -1);
  const aiImporterDesc* by =
      index < 0 ? nullptr : importer.GetImporterInfo(static_cast<std::size_t>(index));
  if (conversion == Conversion::none && by && by->mName) root = own_root(root, by->mName);
  return Gatherer(*scene, name).gathered(root);
}

/// A scene as bytes, from the process that reads it to this one.
class Packed {
 public:
  Packed() = default;
  explicit Packed(std::string bytes) : bytes_(std::move(bytes)) {}

  template <class T>
  void put(const T* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof *values);
  }
  template <class List>
  void put(const List& list) {
    put(list.data(), list.size());
  }
  template <class List>
  void take(List& list) {
    std::size_t count;
    copy(&count, sizeof count);
    list.resize(count);
    copy(list.data(), count * sizeof list[0]);
  }
  bool is_empty() const { return at_ == bytes_.size(); }
  std::string bytes() && { return std::move(bytes_); }

 private:
  void copy(void* to, std::size_t size) {
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }

  std::string bytes_;
  std::size_t at_ = 0;
};

std::string packed(const SceneGraph& scene) {
  Packed packed;
  packed.put(std::vector<std::size_t>{scene.meshes.size()});
  for (const TriangleMesh& mesh : scene.meshes) {
    packed.put(mesh.vertices);
    packed.put(mesh.triangles);
  }
  for (const SceneNode& node : scene.nodes) {
    packed.put(node.name);
    packed.put(node.meshes);
    packed.put(node.to_world.data(), 12);
  }
  return std::move(packed).bytes();
}

SceneGraph unpacked(std::string bytes) {
  Packed packed(std::move(bytes));
  std::vector<std::size_t> meshes;
  packed.take(meshes);
  SceneGraph scene;
  scene.meshes.resize(meshes.at(0));
  for (TriangleMesh& mesh : scene.meshes) {
    packed.take(mesh.vertices);
    packed.take(mesh.triangles);
  }
  while (!packed.is_empty()) {
    SceneNode& node = scene.nodes.emplace_back();
    std::vector<double> numbers;
    packed.take(node.name);
    packed.take(node.meshes);
    packed.take(numbers);
    node.to_world = Eigen::Map<const Transformation>(numbers.data());
  }
  return scene;
}

/// What `read` makes of a file of so many bytes. assimp's readers of some formats crash or do not
/// end where a file is damaged.
template <class Read>
SceneGraph read_guarded(const std::string& name, std::size_t size, const Read& read) {
  // Refused files begin with another letter than those that were read.
  const auto work = [&] {
    try {
      return 's' + packed(read());
    } catch (const Unusable& refusal) {
      return 'u' + std::string(refusal.what());
    }
  };
  constexpr std::size_t mega = 1 << 20;
  const Guard guard{static_cast<unsigned>(30 + size / mega), 2048 * mega + 200 * size};
  Guarded found = guarded(guard, work);
  if (found.signal != 0)
    throw Unusable(name, found.signal == SIGXCPU || found.signal == SIGKILL
                             ? "assimp does not come to its end: damaged?"
                             : "assimp breaks off: damaged?");
  if (found.bytes.starts_with('u')) throw Unusable(found.bytes.substr(1));
  return unpacked(found.bytes.substr(1));
}

/// No post-processing: all of assimp's steps may merge, drop or reorder.
template <class Import>
SceneGraph imported(const std::string& name, std::size_t size, Conversion conversion,
                    const Import& import) {
  return read_guarded(name, size, [&] {
    Assimp::Importer importer;
    return gathered(importer, import(importer), name, conversion);
  });
}

}  // namespace

void SceneGraph::append(TriangleMesh& result, const SceneNode& node, const Transformation& to,
                        const std::string& name) const {
  for (const unsigned number : node.meshes) {
    const TriangleMesh& mesh = meshes[number];
    const std::size_t first = result.vertices.size();
    if (first + mesh.vertices.size() >= std::numeric_limits<std::uint32_t>::max())
      throw Unusable(name, "has more vertices than 32 bits number");
    for (const auto& vertex : mesh.vertices) {
      result.vertices.push_back(image(to, vertex));
      if (!result.vertices.back().allFinite())
        throw Unusable(name, "node '" + node.name + "': a vertex is not finite");
    }
    const auto shift = static_cast<std::uint32_t>(first);
    for (const auto& [i, j, k] : mesh.triangles)
      result.triangles.push_back({i + shift, j + shift, k + shift});
  }
}

TriangleMesh SceneGraph::joined(const std::string& name) const {
  TriangleMesh result;
  for (const SceneNode& node : nodes) append(result, node, node.to_world, name);
  return result;
}

SceneGraph read_with_assimp(const std::filesystem::path& path, std::string_view bytes) {
  return imported(path.string(), bytes.size(), Conversion::none,
                  [&](Assimp::Importer& importer) { return importer.ReadFile(path.string(), 0); });
}

SceneGraph parse_with_assimp(std::string_view bytes, const std::string& name,
                             Conversion conversion) {
  std::string room;
  if (has_mark(bytes)) bytes = as_utf8(bytes, room, name);
  const std::string extension = std::filesystem::path(name).extension().string();
  const char* hint = extension.empty() ? "" : extension.c_str() + 1;
  return imported(name, bytes.size(), conversion, [&](Assimp::Importer& importer) {
    return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint);
  });
}

}  // namespace bvlab
