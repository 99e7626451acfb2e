// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {
namespace {

/// The triangles of one name, and the vertices that they use, in their order.
TriangleMesh selected(const TriangleMesh& mesh,
                      const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<std::uint32_t> used;
  for (const auto& triangle : triangles) used.insert(used.end(), triangle.begin(), triangle.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  TriangleMesh part{{}, triangles};
  for (const auto vertex : used) part.vertices.push_back(mesh.vertices[vertex]);
  for (auto& triangle : part.triangles)
    for (auto& corner : triangle)
      corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) -
                                          used.begin());
  return part;
}

std::vector<MeshPart> parts_of(const ParsedMesh& parsed) {
  if (parsed.parts.empty())
    return {{"", std::make_shared<const TriangleMesh>(parsed.mesh), Pose()}};
  std::vector<std::string> names;  // in the order in which they come
  std::map<std::string, std::vector<std::array<std::uint32_t, 3>>> triangles;
  const auto& all = parsed.mesh.triangles;
  const auto take = [&](const std::string& name, std::size_t first, std::size_t end) {
    if (first == end) return;
    auto& of_name = triangles[name];
    if (of_name.empty()) names.push_back(name);
    of_name.insert(of_name.end(), all.begin() + static_cast<std::ptrdiff_t>(first),
                   all.begin() + static_cast<std::ptrdiff_t>(end));
  };
  take("", 0, parsed.parts[0].first);
  for (std::size_t i = 0; i < parsed.parts.size(); ++i) {
    const bool is_last = i + 1 == parsed.parts.size();
    take(parsed.parts[i].name, parsed.parts[i].first,
         is_last ? all.size() : parsed.parts[i + 1].first);
  }
  std::vector<MeshPart> parts;
  for (const auto& name : names)
    parts.push_back({name,
                     std::make_shared<const TriangleMesh>(selected(parsed.mesh, triangles[name])),
                     Pose()});
  return parts;
}

/// A node's transformation as a pose after what else there is.
struct Decomposed {
  Pose pose;
  Mat3<double> rest;
};

/// The nearest rotation (by singular values), and what is left; less than what float32 loses is
/// nothing.
Decomposed decomposed(const SceneNode& node, const std::string& name) {
  if (!node.to_world.allFinite())
    throw Unusable(name, "node '" + node.name + "': its transformation is not finite");
  const Mat3<double> linear = node.to_world.leftCols<3>();
  Decomposed result{{Mat3<double>::Identity(), node.to_world.col(3)}, linear};
  const auto is_nothing = [](const Mat3<double>& rest) {
    return (rest - Mat3<double>::Identity()).cwiseAbs().maxCoeff() < 1e-6;
  };
  if (linear != Mat3<double>::Identity()) {
    const Eigen::JacobiSVD<Mat3<double>> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3<double> u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
    result.pose.rotation = u * svd.matrixV().transpose();
    result.rest = result.pose.rotation.transpose() * linear;
  }
  if (is_nothing(result.rest)) result.rest = Mat3<double>::Identity();
  return result;
}

std::vector<MeshPart> parts_of(const SceneGraph& scene, const std::string& name) {
  std::vector<MeshPart> parts;
  using Key = std::pair<std::vector<unsigned>, std::array<double, 9>>;
  std::map<Key, std::shared_ptr<const TriangleMesh>> known;
  for (const SceneNode& node : scene.nodes) {
    const auto [pose, rest] = decomposed(node, name);
    Key key{node.meshes, {}};
    std::copy_n(rest.data(), 9, key.second.begin());
    auto& mesh = known[key];
    if (!mesh) {
      SceneNode::Transformation to_part;
      to_part << rest, Vec3<double>::Zero();
      TriangleMesh made;
      scene.append(made, node, to_part, name);
      mesh = std::make_shared<const TriangleMesh>(std::move(made));
    }
    if (!mesh->triangles.empty()) parts.push_back({node.name, mesh, pose});
  }
  return parts;
}

std::vector<MeshPart> checked(std::vector<MeshPart> parts, const std::string& name,
                              const ReadOptions& options) {
  if (parts.empty()) throw Unusable(name, "has no triangles");
  if (options.scale == 1) return parts;
  std::map<const TriangleMesh*, std::shared_ptr<const TriangleMesh>> known;
  for (MeshPart& part : parts) {
    auto& scaled = known[part.mesh.get()];
    if (!scaled)
      scaled = std::make_shared<const TriangleMesh>(scaled_mesh(*part.mesh, name, options));
    part.mesh = scaled;
    part.pose.translation *= options.scale;
    if (!part.pose.translation.allFinite())
      throw Unusable(name, "a coordinate times the scale is not finite");
  }
  return parts;
}

}  // namespace

std::vector<MeshPart> parse_parts(std::string_view bytes, const std::string& name,
                                  const ReadOptions& options) {
  if (const MeshFormat* format = own_format(name))
    return checked(parts_of(parsed_mesh(bytes, name, *format, options)), name, options);
  return checked(parts_of(parsed_scene(bytes, name, options), name), name, options);
}

std::vector<MeshPart> read_parts(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string bytes = bytes_of(path, options), name = path.string();
  if (own_format(name)) return parse_parts(bytes, name, options);
  return checked(parts_of(parsed_scene(bytes, name, options, path), name), name, options);
}

}  // namespace bvlab
