// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/ColladaMetaData.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>

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

Transformation product(const Transformation& parent, const Transformation& child) {
  Transformation t = parent.leftCols<3>() * child;
  t.col(3) += parent.col(3);
  return t;
}

Vec3<double> image(const Transformation& t, const Vec3<double>& v) {
  return t == identity ? v : Vec3<double>(t.leftCols<3>() * v + t.col(3));
}

/// What the scene's root would be if nothing had been added to it for the file's axes and unit.
Transformation own_root(const Transformation& root, std::string_view importer) {
  // All that their roots have is what was added.
  for (const std::string_view name :
       {"Collada", "Discreet 3DS", "Autodesk FBX", "Drawing Interchange Format", "ASE ", "Cinema4D",
        "Inter-Quake", "Quake", "Doom 3", "Return To Castle Wolfenstein"})
    if (importer.starts_with(name)) return identity;
  if (!importer.starts_with("Industry Foundation Classes")) return root;
  // Metres, and a quarter of a turn about x, before the file's own placement.
  Mat3<double> turn;
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const double unit = std::cbrt(root.leftCols<3>().determinant());
  return unit > 0 ? Transformation(turn * root / unit) : root;
}

/// The name in the file; of a DAE's node that has none, its id.
std::string name_of(const aiNode& node) {
  const std::string name = node.mName.C_Str();
  if (!name.starts_with("$ColladaAutoName$")) return name;
  aiString id;
  return node.mMetaData && node.mMetaData->Get(AI_METADATA_COLLADA_ID, id) ? id.C_Str() : "";
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
    SceneNode found{name_of(node), {}, here};
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

// No post-processing: all of assimp's steps may merge, drop or reorder.
SceneGraph read_with_assimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, 1);
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  return gathered(importer, scene, path.string(), Conversion::none);
}

SceneGraph parse_with_assimp(std::string_view bytes, const std::string& name,
                             Conversion conversion) {
  std::string room;
  if (has_mark(bytes)) bytes = as_utf8(bytes, room, name);
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, 1);
  const std::string extension = std::filesystem::path(name).extension().string();
  const char* hint = extension.empty() ? "" : extension.c_str() + 1;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint);
  return gathered(importer, scene, name, conversion);
}

}  // namespace bvlab
