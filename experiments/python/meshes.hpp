// SPDX-License-Identifier: BSD-3-Clause
/// Meshes as Python holds them: read-only once they are made, and shared with whatever uses them,
/// so that nobody can free one that is in use.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "experiments/python/arrays.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Meshes as the engine takes them, one behind the other in memory: copies, with what they are of.
struct SideBySide {
  std::vector<std::weak_ptr<const TriangleMesh>> of;
  std::shared_ptr<const std::vector<TriangleMesh>> copies;
};

struct Mesh : MadeByCalls {
  explicit Mesh(std::shared_ptr<const TriangleMesh> of) : triangles(std::move(of)) {}

  std::shared_ptr<const TriangleMesh> triangles;
  /// Of the last list of several meshes that began with this one.
  std::shared_ptr<SideBySide> last = std::make_shared<SideBySide>();
};

/// The meshes of one call. One mesh is used where it stands. Several are copied by the first call
/// that has them; their first mesh keeps the copies, and the next call with the same list takes
/// those. To be made and destroyed by whoever holds the interpreter's lock.
class Meshes {
 public:
  /// A list of meshes, or of anything with `vertices` and `faces`; or one of them. A list that
  /// repeats itself, [a, b, a, b], is taken for its first part: object i uses mesh i mod their
  /// number. Throws Unusable, also for fewer than `at_least`.
  explicit Meshes(const py::handle& given, std::size_t at_least = 1);

  std::span<const TriangleMesh> span() const { return span_; }
  /// Those that were given, repetitions included.
  std::size_t given() const { return given_; }
  /// Where the engine has that mesh: one of `span`, or what the mesh itself holds.
  const TriangleMesh& place_of(const Mesh& mesh) const;

 private:
  std::size_t given_ = 0;
  std::shared_ptr<const TriangleMesh> one_;
  std::vector<std::weak_ptr<const TriangleMesh>> of_several_;
  std::shared_ptr<const std::vector<TriangleMesh>> several_;
  std::span<const TriangleMesh> span_;
};

/// A Mesh, or anything with `vertices` and `faces`. Throws Unusable.
Mesh mesh_of(const py::handle& given);

void add_meshes(py::module_& module);

}  // namespace bvlab
