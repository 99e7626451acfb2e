// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/places.hpp"
#include "experiments/scenes/public/motions.hpp"
#include "experiments/scenes/random.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

void add_vertices(const aiScene& scene, const aiNode& node, aiMatrix4x4 transformation,
                  aiVector3D& sum, std::size_t& count) {
  transformation *= node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    for (unsigned k = 0; k < mesh.mNumVertices; ++k, ++count)
      sum += transformation * mesh.mVertices[k];
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    add_vertices(scene, *node.mChildren[i], transformation, sum, count);
}

/// What OMPL.app moves a robot about: the mean of its vertices as assimp gives them to it, which
/// depends on how often each was written.
Vec3<double> middle_of_vertices(const std::string& bytes, const std::string& name) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(
      bytes.data(), bytes.size(),
      aiProcess_GenNormals | aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
          aiProcess_SortByPType | aiProcess_OptimizeGraph,
      std::filesystem::path(name).extension().string().c_str() + 1);
  aiVector3D sum;
  std::size_t count = 0;
  if (scene && scene->mRootNode) add_vertices(*scene, *scene->mRootNode, {}, sum, count);
  if (count == 0) throw Unusable(name, "has no vertices");
  sum /= static_cast<float>(count);
  return {sum.x, sum.y, sum.z};
}

/// As assimp gives it to OMPL.app, whose states are in those axes and units.
NamedMesh given_to_ompl(const PublicFiles& files, const std::string& path) {
  return {stem(path), parse_with_assimp(files[path], path, Conversion::of_assimp).joined(path)};
}

/// The robot about its middle, then the environment.
std::vector<NamedMesh> meshes_of(const PublicFiles& files, const std::string& robot,
                                 const std::string& environment) {
  std::vector<NamedMesh> meshes{given_to_ompl(files, robot), given_to_ompl(files, environment)};
  const Vec3<double> middle = middle_of_vertices(files[robot], robot);
  for (auto& vertex : meshes[0].mesh.vertices) vertex -= middle;
  return meshes;
}

/// The mesh's own origin, which is its middle now.
Extent about_origin(const TriangleMesh& mesh) {
  Extent extent = extent_of(mesh);
  extent.radius += extent.centre.norm();
  extent.centre = Vec3<double>::Zero();
  return extent;
}

double dot(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/// On the straight line, and on the great circle between the attitudes.
Place between(const Place& a, const Place& b, double share) {
  Place place;
  place.centre = a.centre + share * (b.centre - a.centre);
  const double cosine = dot(a.attitude, b.attitude);
  const double angle = std::acos(std::min(1.0, std::abs(cosine)));
  const bool near = angle < 1e-6;
  const double from = near ? 1 - share : std::sin((1 - share) * angle) / std::sin(angle);
  const double to =
      (near ? share : std::sin(share * angle) / std::sin(angle)) * (cosine < 0 ? -1 : 1);
  for (std::size_t k = 0; k < 4; ++k) place.attitude[k] = from * a.attitude[k] + to * b.attitude[k];
  place.attitude = normalised(place.attitude);
  return place;
}

/// How far a body of that radius moves, at most.
double distance(const Place& a, const Place& b, double radius) {
  return (b.centre - a.centre).norm() +
         radius * 2 * std::acos(std::min(1.0, std::abs(dot(a.attitude, b.attitude))));
}

Place state_of(TextScanner& line) {
  Place place;
  for (int d = 0; d < 3; ++d) place.centre[d] = line.coordinate();
  for (const std::size_t k : {1, 2, 3, 0}) place.attitude[k] = line.coordinate();
  if (!(dot(place.attitude, place.attitude) > 0)) line.fault("a quaternion of length 0");
  place.attitude = normalised(place.attitude);
  return place;
}

std::vector<Place> states_of(const std::string& bytes, const std::string& name) {
  std::vector<Place> states;
  for (TextScanner line(bytes, name); line.next_line();) states.push_back(state_of(line));
  if (states.empty()) throw Unusable(name, "has no states");
  return states;
}

void add_frame(Array<double>& trace, const Place& robot, const Extent& extent) {
  append(trace.data, robot, extent);
  trace.data.insert(trace.data.end(), {0, 0, 0, 1, 0, 0, 0});
}

/// Where a search may go, and from where to where.
struct Bounds {
  Vec3<double> lo, hi;
  Place start, goal;
};

/// A rapidly exploring random tree (kuffner2000rrt): every frame is a placement that it asks about.
Array<double> searched(const Bounds& bounds, const Extent& robot, const TouchesAny& touches,
                       std::size_t frames) {
  Random random(1);
  Array<double> trace{{frames, 2, 7}, {}};
  std::vector<Place> tree{bounds.start};
  std::vector<Pose> poses(2);
  const double step = 0.05 * robot.radius;
  while (trace.data.size() < frames * 14) {
    Place target = bounds.goal;
    if (!random.happens(0.1)) {
      for (int d = 0; d < 3; ++d) target.centre[d] = random.uniform(bounds.lo[d], bounds.hi[d]);
      target.attitude = random.rotation();
    }
    const Place from =
        *std::min_element(tree.begin(), tree.end(), [&](const Place& a, const Place& b) {
          return distance(a, target, robot.radius) < distance(b, target, robot.radius);
        });
    const double steps = std::ceil(std::max(1.0, distance(from, target, robot.radius) / step));
    for (double k = 1; k <= steps && trace.data.size() < frames * 14; ++k) {
      const Place at = between(from, target, k / steps);
      add_frame(trace, at, robot);
      poses[0] = pose_of(at, robot);
      if (touches && touches(0, poses)) break;
      tree.push_back(at);
    }
  }
  return trace;
}

PublicMotion search(std::vector<NamedMesh> meshes, const Bounds& bounds,
                    const MotionRequest& request) {
  PublicMotion motion{std::move(meshes), {}};
  const std::vector<TriangleMesh> both{motion.meshes[0].mesh, motion.meshes[1].mesh};
  motion.trace = searched(bounds, about_origin(both[0]), request.touches(both), request.frames);
  return motion;
}

/// The values of a .cfg, whose lines are `key = value`.
std::map<std::string, std::string> values_of(const std::string& bytes, const std::string& name) {
  std::map<std::string, std::string> values;
  for (TextScanner line(bytes, name); line.next_line();) {
    std::string text(line.line());
    const std::size_t equals = text.find('=');
    if (equals == text.npos) continue;
    const auto trimmed = [](std::string word) {
      word.erase(0, word.find_first_not_of(" \t"));
      word.erase(word.find_last_not_of(" \t\r") + 1);
      return word;
    };
    values.emplace(trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1)));
  }
  return values;
}

class Problem {
 public:
  Problem(const std::string& bytes, std::string name)
      : values_(values_of(bytes, name)), name_(std::move(name)) {}

  double number(const std::string& key) const {
    const auto found = values_.find(key);
    double value = 0;
    if (found == values_.end()) throw Unusable(name_, "has no " + key);
    if (!TextScanner::parse(found->second, value) || !std::isfinite(value))
      throw Unusable(name_, key + " = " + found->second + ": not a number");
    return value;
  }
  Vec3<double> point(const std::string& key) const {
    return {number(key + ".x"), number(key + ".y"), number(key + ".z")};
  }
  Place place(const std::string& key) const {
    Place place;
    place.centre = point(key);
    Vec3<double> axis = point(key + ".axis");
    const double half = number(key + ".theta") / 2;
    if (axis.norm() == 0) return place;
    axis /= axis.norm();
    place.attitude = {std::cos(half), std::sin(half) * axis[0], std::sin(half) * axis[1],
                      std::sin(half) * axis[2]};
    return place;
  }

 private:
  std::map<std::string, std::string> values_;
  std::string name_;
};

}  // namespace

PublicMotion ompl_path(const PublicFiles& files, const std::string& robot,
                       const std::string& environment, const std::string& path,
                       const MotionRequest& request) {
  PublicMotion motion{meshes_of(files, robot, environment), {{request.frames, 2, 7}, {}}};
  const Extent extent = about_origin(motion.meshes[0].mesh);
  const auto states = states_of(files[path], path);
  std::vector<double> way{0};
  for (std::size_t k = 1; k < states.size(); ++k)
    way.push_back(way.back() + distance(states[k - 1], states[k], extent.radius));
  std::size_t leg = 1;
  for (std::size_t frame = 0; frame < request.frames; ++frame) {
    const double at = request.frames > 1 ? way.back() * static_cast<double>(frame) /
                                               static_cast<double>(request.frames - 1)
                                         : 0;
    while (leg + 1 < way.size() && way[leg] < at) ++leg;
    if (states.size() == 1) {
      add_frame(motion.trace, states[0], extent);
      continue;
    }
    const double length = way[leg] - way[leg - 1];
    const double share = length > 0 ? std::clamp((at - way[leg - 1]) / length, 0.0, 1.0) : 0;
    add_frame(motion.trace, between(states[leg - 1], states[leg], share), extent);
  }
  return motion;
}

PublicMotion ompl_search(const PublicFiles& files, const std::string& robot,
                         const std::string& environment, const std::string& problem,
                         const MotionRequest& request) {
  const Problem said(files[problem], problem);
  const Bounds bounds{said.point("volume.min"), said.point("volume.max"), said.place("start"),
                      said.place("goal")};
  return search(meshes_of(files, robot, environment), bounds, request);
}

PublicMotion search_among(const PublicFiles& files, const std::string& robot,
                          const std::string& environment, const MotionRequest& request) {
  std::vector<NamedMesh> meshes{{stem(robot), parse_mesh(files[robot], robot)},
                                {stem(environment), parse_mesh(files[environment], environment)}};
  const Extent middle = extent_of(meshes[0].mesh);
  for (auto& vertex : meshes[0].mesh.vertices) vertex -= middle.centre;
  Bounds bounds;
  bounds.lo = bounds.hi = meshes[1].mesh.vertices.at(0);
  for (const auto& vertex : meshes[1].mesh.vertices)
    bounds.lo = bounds.lo.cwiseMin(vertex), bounds.hi = bounds.hi.cwiseMax(vertex);
  bounds.start.centre = (bounds.lo + bounds.hi) / 2;
  bounds.goal.centre = bounds.hi;
  return search(std::move(meshes), bounds, request);
}

}  // namespace bvlab
