// SPDX-License-Identifier: BSD-3-Clause
/// What others' files say, as meshes and traces. Each throws Unusable, naming the file and what is
/// wrong, where a file is not of its form or has fewer frames than wanted.
#pragma once

#include <string>
#include <vector>

#include "broadphase/box.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/public/public_files.hpp"
#include "experiments/scenes/scene.hpp"

namespace bvlab {

/// A file's name without its folder and extension.
inline std::string stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

/// Meshes, and the motion of as many objects: shape (frames, meshes, 7).
struct PublicMotion {
  std::vector<NamedMesh> meshes;
  Array<double> trace;
};

/// What a motion has to be, and what is lent to make it.
struct MotionRequest {
  std::size_t frames = 0;
  /// For motions that nobody recorded: whether an object touches another one.
  std::function<TouchesAny(std::span<const TriangleMesh>)> touches;
};

/// OMPL.app's problem: a robot that is moved about the mean of its vertices, in an environment that
/// stands, along the states of a path, interpolated so that steps are equally long. Both meshes are
/// COLLADA (or whatever assimp reads).
PublicMotion ompl_path(const PublicFiles& files, const std::string& robot,
                       const std::string& environment, const std::string& path,
                       const MotionRequest& request);

/// The same without a path: what a rapidly exploring random tree asks about that grows from the
/// problem's start, within its bounds. `problem` is a .cfg.
PublicMotion ompl_search(const PublicFiles& files, const std::string& robot,
                         const std::string& environment, const std::string& problem,
                         const MotionRequest& request);

/// FCL's pair of meshes: the same search, within the environment's box, from its middle.
PublicMotion search_among(const PublicFiles& files, const std::string& robot,
                          const std::string& environment, const MotionRequest& request);

/// PQP's demo: two triangle soups (.tris), and for each a path of matrices, step by step.
PublicMotion pqp_paths(const PublicFiles& files, const std::string& first,
                       const std::string& second, const MotionRequest& request);

/// A robot arm: link i is `meshes` i; joints out of a URDF's chain of revolute joints, their angles
/// out of a log that pybullet wrote of body 0 (STATE_LOGGING_GENERIC_ROBOT).
PublicMotion arm(const PublicFiles& files, const std::string& urdf, const std::string& log,
                 const std::vector<std::string>& meshes, const MotionRequest& request);

/// The boxes of a mesh's edges, each swept from one frame of a simulation to the next, in `frames`
/// equal parts of that step: shape (frames, edges, 6). `before` and `after` have the same faces.
Array<float> swept_edges(const PublicFiles& files, const std::string& before,
                         const std::string& after, std::size_t frames);

}  // namespace bvlab
