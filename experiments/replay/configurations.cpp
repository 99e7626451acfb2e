// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/configurations.hpp"

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <utility>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "traversal/recommended_distances.hpp"
#include "traversal/recommended_for.hpp"

namespace bvlab {
namespace {

struct Configuration {
  std::string_view name, description;
  void (*set)(Variant&);
};

/// What a tree on demand takes in frames until all of it is made, in nanoseconds a triangle.
constexpr double whole_in_frames = 800;

/// What a run begins with: no other trees cost less before the first frame.
void set_recommended(Variant& variant) {
  variant = variant_of<Recommended>(variant);
  variant.chooses_in_turn = true;
}

/// li1998incremental, with the list that it found best.
void set_as_published(Variant& variant) {
  set_tree(variant, "binary");
  variant.volume = "sphere", variant.strategy = "deferred";
  variant.build = "top-down-principal", variant.fit = "published", variant.leaf_size = 1;
}

constexpr Configuration list[] = {
    {"recommended",
     "begins with (1) slab-box, kernel siblings, built on-demand, leaves as large as a register, "
     "margins, and goes on with what takes the least time in trials of ten frames beside it, as "
     "far as the run repays trials and trees. touching and contacts: (2) the same, recursive; (3) "
     "slab-box, kernel mixed, built top-down-surface-area, leaves of 4, margins; (4) obb, kernel "
     "mixed, built bottom-up, leaves of 4, margins, (5) the same, recursive, or (6) as (4) "
     "with fit tight. distance: (1), then rss, kernel mixed, built bottom-up, leaves of 4, "
     "margins. What goes on depends on "
     "times: counts, the last bits of distances, and which of several nearest pairs is named may "
     "differ from run to run",
     set_recommended},
    {"as-published",
     "the talk's (Li and Chen 1998): spheres in binary trees, one triangle per leaf, and a "
     "separation list that is rebuilt one run late (deferred)",
     set_as_published},
};

/// Whether the program has it: it may have been configured without some volumes.
bool is_compiled(const Variant& variant) {
  if (variant.kernel != "gathered") return wide_fan_out(variant.volume, variant.kernel) > 0;
  return has(volumes(), variant.volume) && has(strategies(), variant.strategy);
}

}  // namespace

std::vector<Recommendation> recommendations(Variant variant, std::span<const TriangleMesh> meshes) {
  variant.chooses_in_turn = false;
  std::vector<Recommendation> all;
  const auto add = [&]<class Best>(const RecommendedCandidate<Best>& candidate) {
    constexpr bool on_demand = std::is_same_v<typename Best::Build, builds::OnDemand>;
    all.push_back({variant_of<Best>(variant), std::string(candidate.name), candidate.build,
                   on_demand ? whole_in_frames : 0});
  };
  if (variant.query == "distance") {
    add(std::get<0>(recommended_candidates));
    add(RecommendedCandidate<RecommendedDistances>{"rectangle swept spheres", 1350});
  } else {
    for_each_candidate(add);
    // Oriented boxes, which fit long triangles, before slab-boxes in small leaves.
    if (elongation(meshes) >= long_triangles)
      std::rotate(all.begin() + 2, all.begin() + 3, all.begin() + 5);
  }
  std::erase_if(all, [](const Recommendation& each) { return !is_compiled(each.variant); });
  // As the variant says, where the program has none of them.
  if (all.empty()) all.push_back({variant, "what is there", 0});
  return all;
}

std::vector<Named> configurations() {
  std::vector<Named> all;
  for (const auto& each : list)
    all.push_back({std::string(each.name), std::string(each.description)});
  return all;
}

void refuse_beside_configuration(std::string_view parameter) {
  throw Unusable(std::string(parameter) +
                 ": is set by the configuration, too; leave one of them out");
}

Variant configured(Variant variant, std::string_view configuration) {
  for (const auto& each : list)
    if (each.name == configuration) {
      each.set(variant);
      return variant;
    }
  throw Unusable("--configuration " + std::string(configuration) +
                 ": unknown; available: " + joined(list, &Configuration::name));
}

}  // namespace bvlab
