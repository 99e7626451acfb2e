// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/near_within.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {
namespace {

/// Farther out by at least `reach`, or everywhere.
Box<float> larger(Box<float> box, double reach) {
  constexpr float most = std::numeric_limits<float>::max();
  for (int axis = 0; axis < 3; ++axis) {
    // One rounding of the difference, which the step to the next float makes good.
    box.lo[axis] =
        std::max(rounded_down<float>(std::nextafter(box.lo[axis] - reach, -HUGE_VAL)), -most);
    box.hi[axis] =
        std::min(rounded_up<float>(std::nextafter(box.hi[axis] + reach, HUGE_VAL)), most);
  }
  return box;
}

}  // namespace

NearWithin::NearWithin(std::span<const TriangleMesh> meshes, std::size_t objects)
    : method_(make_method<float>("auto", {.coherence = Coherence::off})) {
  for (std::size_t i = 0; i < objects; ++i) add(meshes[i % meshes.size()]);
}

void NearWithin::add(const TriangleMesh& mesh) {
  const auto [at, fresh] = known_.try_emplace(&mesh, of_meshes_.size());
  if (fresh) of_meshes_.emplace_back(mesh);
  mesh_of_.push_back(at->second);
}

std::vector<ObjectPair> NearWithin::pairs(std::span<const Pose> poses,
                                          std::span<const std::uint8_t> present, double distance) {
  boxes_.clear(), of_boxes_.clear();
  Vec3<double> origin = Vec3<double>::Zero();
  for (std::size_t i = 0; i < mesh_of_.size(); ++i) {
    if (!present[i]) continue;
    const RotatedMeshBox& of_mesh = of_meshes_[mesh_of_[i]];
    // Relative to the first body: what boxes lose by being float makes them larger.
    if (boxes_.empty()) origin = of_mesh.mesh_origin(poses[i]);
    const Box<float> box = of_mesh(poses[i], origin);
    // Half of the largest number and more are too large for floats.
    boxes_.push_back(larger(box, std::min(distance, std::numeric_limits<double>::max()) / 2));
    of_boxes_.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<ObjectPair> found;
  for (const Pair& pair : method_->overlapping(boxes_))
    found.push_back({of_boxes_[pair.i], of_boxes_[pair.j]});
  std::sort(found.begin(), found.end(), [](const ObjectPair& a, const ObjectPair& b) {
    return a.i != b.i ? a.i < b.i : a.j < b.j;
  });
  return found;
}

}  // namespace bvlab
