// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/configurations.hpp"

#include "experiments/files/unusable.hpp"

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
    variant.tree = "binary", variant.volume = "rss", variant.strategy = "recursive";
    variant.build = "bottom-up", variant.fit = "tight", variant.leaf_size = 1;
  } else {
    variant.tree = "wide", variant.volume = "slab-box", variant.strategy = "margins";
    variant.build = "top-down-surface-area", variant.fit = "published", variant.leaf_size = 16;
  }
}

/// li1998incremental, with the list that it found best.
void set_as_published(Variant& variant) {
  variant.tree = "binary", variant.volume = "sphere", variant.strategy = "deferred";
  variant.build = "top-down-principal", variant.fit = "published", variant.leaf_size = 1;
}

constexpr Configuration list[] = {
    {"recommended",
     "touching and contacts: slab-box in wide trees, built top-down-surface-area, 16 triangles a "
     "leaf, margins; distance: rss in binary ones, built bottom-up, fit tight, one a leaf, "
     "recursive",
     set_recommended},
    {"as-published",
     "the talk's (Li and Chen 1998): spheres in binary trees, one triangle a leaf, and a "
     "separation list that is rebuilt one run late (deferred)",
     set_as_published},
};

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

}  // namespace bvlab
