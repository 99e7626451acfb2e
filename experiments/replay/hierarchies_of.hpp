// SPDX-License-Identifier: BSD-3-Clause
/// What a variant says of hierarchies, made.
#pragma once

#include <span>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "experiments/replay/topology_of.hpp"
#include "experiments/replay/volume_entry.hpp"
#include "hierarchies/hierarchy.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

/// The variant's names have been checked.
inline Fit fit_of(const Variant& variant) {
  return variant.fit == "tight" ? Fit::tight : Fit::published;
}

/// One hierarchy for each mesh.
template <BoundingVolume V>
class HierarchiesOf final : public AnyHierarchies {
 public:
  HierarchiesOf(std::span<const TriangleMesh> meshes, const Variant& variant) : meshes_(meshes) {
    all_.reserve(meshes.size());
    for (const auto& mesh : meshes)
      if (variant.fan_out == 2)
        all_.emplace_back(mesh, topology_of(mesh, variant), fit_of(variant));
      else
        all_.emplace_back(mesh, wide_topology_of(mesh, variant), fit_of(variant));
  }

  std::size_t meshes() const override { return all_.size(); }
  const TriangleMesh& mesh(std::size_t i) const override { return meshes_[i]; }
  const Hierarchy<V>& operator[](std::size_t i) const { return all_[i]; }

  ShapeOver<Hierarchy<V>> shape(std::size_t mesh) const { return {&meshes_[mesh], &all_[mesh]}; }
  /// Object i uses mesh i mod the number of meshes.
  std::vector<ShapeOver<Hierarchy<V>>> shapes(std::size_t objects) const {
    return shapes_over(meshes_, all_, objects);
  }

 private:
  std::span<const TriangleMesh> meshes_;
  std::vector<Hierarchy<V>> all_;
};

}  // namespace bvlab
