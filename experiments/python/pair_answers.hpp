// SPDX-License-Identifier: BSD-3-Clause
/// What a World answers beside which pairs touch: which pairs can be near each other, and the
/// contacts and distances of some, each from the roots of its trees.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "hierarchies/geometry/pose.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

/// The order in which pairs are listed.
inline bool before(const ObjectPair& a, const ObjectPair& b) {
  return a.i != b.i ? a.i < b.i : a.j < b.j;
}

class PairAnswers {
 public:
  /// Object i uses mesh i mod meshes.size(); the meshes must outlive this. Of the variant, volume,
  /// build, leaf size, fit and precision count. Trees are built when they are first asked.
  PairAnswers(std::span<const TriangleMesh> meshes, std::size_t objects, const Variant& variant);
  ~PairAnswers();

  /// Adds an object of that mesh, which must outlive this, by the next number.
  void add(const TriangleMesh& mesh);
  std::size_t size() const;

  /// The pairs that can be within a distance of each other, which may be infinite: those whose
  /// boxes, made larger by half of it on every side, meet. i < j, sorted; of the present alone.
  std::vector<ObjectPair> near(std::span<const Pose> poses, std::span<const std::uint8_t> present,
                               double distance);

  /// Object i, object j, triangle of i, triangle of j: pair by pair, sorted in each. `poses` has
  /// one for each object.
  std::vector<std::array<std::uint32_t, 4>> contacts(std::span<const ObjectPair> pairs,
                                                     std::span<const Pose> poses);
  /// Of each pair, in units of the meshes, 0 where they touch; and the triangles that have it.
  std::vector<NearestTriangles> distances(std::span<const ObjectPair> pairs,
                                          std::span<const Pose> poses);

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace bvlab
