// SPDX-License-Identifier: BSD-3-Clause
/// The pairs of bodies that can be within a distance of each other: those whose boxes, made larger
/// by half of it on every side, meet.
#pragma once

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "experiments/replay/box_methods.hpp"
#include "traversal/rotated_mesh_box.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

class NearWithin {
 public:
  /// Object i uses mesh i mod meshes.size().
  NearWithin(std::span<const TriangleMesh> meshes, std::size_t objects);

  /// Adds an object of that mesh, by the next number.
  void add(const TriangleMesh& mesh);
  std::size_t size() const { return mesh_of_.size(); }

  /// i < j, sorted. Of who is not present nothing is known. `distance` may be infinite.
  std::vector<ObjectPair> pairs(std::span<const Pose> poses, std::span<const std::uint8_t> present,
                                double distance);

 private:
  std::vector<RotatedMeshBox> of_meshes_;
  std::vector<std::uint32_t> mesh_of_;  // of each object
  std::unordered_map<const TriangleMesh*, std::uint32_t> known_;
  std::unique_ptr<AnyMethod<float>> method_;
  std::vector<Box<float>> boxes_;        // of those that are present
  std::vector<std::uint32_t> of_boxes_;  // whose each is
};

}  // namespace bvlab
