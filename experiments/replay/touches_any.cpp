// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/touches_any.hpp"

#include <memory>
#include <vector>

#include "experiments/replay/triangle_test.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "traversal/body.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/traverse.hpp"

namespace bvlab {
namespace {

using Volume = Sphere<float>;
using Lanes = Batch<float, 8>;

class Touch {
 public:
  Touch(std::span<const TriangleMesh> meshes, std::size_t objects) {
    hierarchies_.reserve(meshes.size());
    for (const auto& mesh : meshes)
      hierarchies_.emplace_back(mesh, builds::TopDownPrincipal::topology(mesh, 1));
    bodies_.reserve(objects);
    for (std::size_t i = 0; i < objects; ++i)
      bodies_.emplace_back(meshes[i % meshes.size()], hierarchies_[i % meshes.size()]);
  }

  bool operator()(std::size_t object, std::span<const Pose> poses) {
    // What has not moved since the last question is not posed again.
    for (std::size_t i = 0; i < poses.size(); ++i) bodies_[i].move(poses[i], Vec3<double>::Zero());
    for (std::size_t other = 0; other < poses.size(); ++other) {
      if (other == object) continue;
      Touching query;
      NotCounting counter;
      traverse_from_roots<Lanes>(bodies_[object], bodies_[other], query, counter, workspace_);
      if (query.touching()) return true;
    }
    return false;
  }

 private:
  std::vector<Hierarchy<Volume>> hierarchies_;
  std::vector<Body<Volume>> bodies_;
  Workspace workspace_;
};

}  // namespace

TouchesAny touches_any(std::span<const TriangleMesh> meshes, std::size_t objects) {
  auto touch = std::make_shared<Touch>(meshes, objects);
  return
      [touch](std::size_t object, std::span<const Pose> poses) { return (*touch)(object, poses); };
}

}  // namespace bvlab
