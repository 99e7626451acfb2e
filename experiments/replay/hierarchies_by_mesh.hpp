// SPDX-License-Identifier: BSD-3-Clause
/// Hierarchies of bodies that come one after the other: each is built when the first body of its
/// mesh comes, and found by the mesh's address from then on.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "experiments/replay/volume_entry.hpp"

namespace bvlab {

/// The hierarchy of one mesh.
struct OneOfHierarchies {
  const AnyHierarchies* hierarchies;
  std::size_t mesh;
};

class HierarchiesByMesh {
 public:
  /// `first` are hierarchies of that volume, made by the variant.
  HierarchiesByMesh(const VolumeEntry& volume, std::shared_ptr<const AnyHierarchies> first,
                    const Variant& variant)
      : volume_(&volume), variant_(variant) {
    keep(std::move(first));
  }

  /// Those of the meshes that were known at first.
  const AnyHierarchies& first() const { return *all_.front(); }
  /// The mesh must outlive this.
  OneOfHierarchies of(const TriangleMesh& mesh) {
    if (const auto at = known_.find(&mesh); at != known_.end()) return at->second;
    keep(volume_->hierarchies(std::span(&mesh, 1), variant_));
    return known_.at(&mesh);
  }

 private:
  void keep(std::shared_ptr<const AnyHierarchies> made) {
    for (std::size_t i = 0; i < made->meshes(); ++i)
      known_.try_emplace(&made->mesh(i), OneOfHierarchies{made.get(), i});
    all_.push_back(std::move(made));
  }

  const VolumeEntry* volume_;
  Variant variant_;
  std::vector<std::shared_ptr<const AnyHierarchies>> all_;
  std::unordered_map<const TriangleMesh*, OneOfHierarchies> known_;
};

}  // namespace bvlab
