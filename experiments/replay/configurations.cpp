// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/configurations.hpp"

#include <iomanip>
#include <sstream>
#include <utility>

#include "experiments/files/unusable.hpp"
#include "traversal/recommended.hpp"

namespace bvlab {
namespace {

struct Configuration {
  std::string_view name, description;
  void (*set)(Variant&);
};

/// What took the least time in narrow-phase.toml and hierarchies.toml. Where triangles that touch
/// are sought, wide trees are fastest from the roots, and margins save more than they cost wherever
/// pairs are quiet (at most a tenth is lost where none is). Distances are sought by the volumes of
/// triangles, which swept rectangles bound best.
void set_recommended(Variant& variant) {
  if (variant.query == "distance") {
    set_tree(variant, "binary");
    variant.volume = "rss", variant.strategy = "recursive";
    variant.build = "bottom-up", variant.fit = "tight", variant.leaf_size = 1;
  } else {
    set_tree(variant, "wide");
    variant.volume = "slab-box", variant.strategy = "margins";
    variant.build = "top-down-surface-area", variant.fit = "published", variant.leaf_size = 16;
  }
}

/// li1998incremental, with the list that it found best.
void set_as_published(Variant& variant) {
  set_tree(variant, "binary");
  variant.volume = "sphere", variant.strategy = "deferred";
  variant.build = "top-down-principal", variant.fit = "published", variant.leaf_size = 1;
}

constexpr Configuration list[] = {
    {"recommended",
     "touching and contacts: slab-box under the kernel siblings, built top-down-surface-area, 16 "
     "triangles a leaf, margins; where triangles are long, obb under mixed, built bottom-up, fit "
     "tight, 4 a leaf, margins; distance: rss in binary trees, built bottom-up, fit tight, one a "
     "leaf, recursive",
     set_recommended},
    {"as-published",
     "the talk's (Li and Chen 1998): spheres in binary trees, one triangle a leaf, and a "
     "separation list that is rebuilt one run late (deferred)",
     set_as_published},
};

Chosen recommended(Variant variant, std::span<const TriangleMesh> meshes) {
  set_recommended(variant);
  if (variant.query == "distance")
    return {variant,
            "distances are sought by the volumes of triangles, which swept rectangles "
            "bound best"};
  const double elongated = elongation(meshes);
  std::ostringstream measured;
  measured << std::setprecision(3) << elongated;
  if (elongated < long_triangles)
    return {variant, "triangles are hardly longer than wide (" + measured.str() +
                         "): boxes along the mesh's axes, cut by a slab, fit them and cost least"};
  set_kernel(variant, "mixed");
  variant.volume = "obb", variant.strategy = "margins";
  variant.build = "bottom-up", variant.fit = "tight", variant.leaf_size = 4;
  return {variant, "triangles are long (" + measured.str() +
                       "): oriented boxes fit them, others are mostly empty"};
}

}  // namespace

std::vector<Named> configurations() {
  std::vector<Named> all;
  for (const auto& each : list)
    all.push_back({std::string(each.name), std::string(each.description)});
  return all;
}

Variant configured(Variant variant, std::string_view configuration) {
  std::string names;
  for (const auto& each : list) {
    if (each.name == configuration) {
      each.set(variant);
      return variant;
    }
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  throw Unusable("--configuration " + std::string(configuration) + ": unknown; there are " + names);
}

Chosen configured(Variant variant, std::string_view configuration,
                  std::span<const TriangleMesh> meshes) {
  if (configuration == "recommended") return recommended(std::move(variant), meshes);
  return {configured(std::move(variant), configuration), ""};
}

}  // namespace bvlab
