// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"

namespace bvlab {
namespace {

using Transformation = Eigen::Matrix<double, 3, 4>;

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

class Gatherer {
 public:
  Gatherer(const aiScene& scene, const std::string& name) : scene_(scene), name_(name) {}

  TriangleMesh gathered() {
    if (scene_.mRootNode) visit(*scene_.mRootNode, Transformation::Identity(), 0);
    return std::move(result_);
  }

 private:
  void visit(const aiNode& node, const Transformation& parent, int depth) {
    if (depth > 1000) throw Unusable(name_, "nodes more than 1000 deep");
    const Transformation here = product(parent, transformation_of(node));
    for (unsigned i = 0; node.mMeshes && i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= scene_.mNumMeshes)
        throw Unusable(name_, "node '" + std::string(node.mName.C_Str()) + "': mesh " +
                                  std::to_string(node.mMeshes[i]) + " does not exist");
      if (const aiMesh* mesh = scene_.mMeshes[node.mMeshes[i]])
        append(*mesh, node.mMeshes[i], here);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i)
      if (node.mChildren[i]) visit(*node.mChildren[i], here, depth + 1);
  }

  void append(const aiMesh& mesh, unsigned number, const Transformation& here) {
    const auto fault = [&](const std::string& what) {
      throw Unusable(name_, "mesh " + std::to_string(number) + ": " + what);
    };
    // Some of assimp's readers leave arrays out where they found nothing to put in.
    if (!mesh.mVertices || !mesh.mFaces) return;
    const std::size_t first = result_.vertices.size();
    if (first + mesh.mNumVertices >= std::numeric_limits<std::uint32_t>::max())
      fault("more vertices than 32 bits number");
    const bool stands = here == Transformation::Identity();
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      Vec3<double> p(v.x, v.y, v.z);
      if (!stands) p = here.leftCols<3>() * p + here.col(3);
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
        fault("vertex " + std::to_string(i) + " is not finite");
      result_.vertices.push_back(p);
    }
    std::vector<std::uint32_t> corners;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      corners.clear();
      for (unsigned k = 0; face.mIndices && k < face.mNumIndices; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices)
          fault("face " + std::to_string(i) + ": vertex " + std::to_string(face.mIndices[k]) +
                " does not exist: there are " + std::to_string(mesh.mNumVertices));
        corners.push_back(static_cast<std::uint32_t>(first) + face.mIndices[k]);
      }
      append_polygon(result_, corners);
    }
  }

  const aiScene& scene_;
  const std::string& name_;
  TriangleMesh result_;
};

TriangleMesh gathered(const Assimp::Importer& importer, const aiScene* scene,
                      const std::string& name) {
  if (!scene) {
    std::string why = importer.GetErrorString();
    why = why.substr(0, why.find('\n'));
    throw Unusable(name,
                   "not a mesh that assimp reads: " + (why.empty() ? "no reason given" : why));
  }
  return Gatherer(*scene, name).gathered();
}

}  // namespace

// No post-processing: all of assimp's steps may merge, drop or reorder.
TriangleMesh read_with_assimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  return gathered(importer, importer.ReadFile(path.string(), 0), path.string());
}

TriangleMesh parse_with_assimp(std::string_view bytes, const std::string& name,
                               const std::string& extension) {
  Assimp::Importer importer;
  const char* hint = extension.empty() ? "" : extension.c_str() + 1;
  return gathered(importer, importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint), name);
}

}  // namespace bvlab
