// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/configurations.hpp"

#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/registry.hpp"
#include "traversal/recommended_distances.hpp"
#include "traversal/recommended_for.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab {
namespace {

struct Configuration {
  std::string_view name, description;
  void (*set)(Variant&);
};

/// A candidate of the library (traversal/recommended_for.hpp), in the program's names.
template <class Best>
Variant as(Variant variant) {
  set_kernel(variant, Best::Kernel::name);
  variant.volume = Best::Volume::name, variant.strategy = Best::Memory::name;
  variant.build = Best::Build::name, variant.leaf_size = Best::leaf_size;
  variant.fit = name_of(Best::fit);
  return variant;
}

/// Where the motion is not known. Margins save more than they cost wherever pairs are quiet: up to
/// nine tenths of the time from the roots, where they cost up to a third more if none is. Distances
/// are sought by the volumes of triangles, which rectangle swept spheres bound best.
void set_recommended(Variant& variant) {
  if (variant.query != "distance") {
    variant = as<Recommended>(variant);
    return;
  }
  using Best = RecommendedDistances;
  set_tree(variant, "binary");
  variant.frame = name_of(Best::frame), variant.volume = Best::Volume::name;
  variant.strategy =
      has(strategies(), Best::Strategy::name) ? Best::Strategy::name : Recursive::name;
  variant.build = Best::Build::name, variant.leaf_size = Best::leaf_size;
  variant.fit = name_of(Best::fit);
}

/// li1998incremental, with the list that it found best.
void set_as_published(Variant& variant) {
  set_tree(variant, "binary");
  variant.volume = "sphere", variant.strategy = "deferred";
  variant.build = "top-down-principal", variant.fit = "published", variant.leaf_size = 1;
}

constexpr Configuration list[] = {
    {"recommended",
     "touching and contacts: the cheapest, in counted samples of the motion, of (1) slab-box, "
     "kernel siblings, built top-down-surface-area, leaves as large as a register; (2) obb, kernel "
     "mixed, built bottom-up, fit tight, leaves of 4; either of them with margins or recursive; "
     "with margins (3) slab-box, kernel siblings, built bottom-up, leaves of 4; (4) obb, kernel "
     "siblings, built bottom-up, fit tight, leaves of 8. Where the motion is not known, (1) or (2) "
     "with margins, by the shape of the triangles. distance: rss in binary trees, frame body, "
     "built bottom-up, fit tight, leaves of 1, witness",
     set_recommended},
    {"as-published",
     "the talk's (Li and Chen 1998): spheres in binary trees, one triangle per leaf, and a "
     "separation list that is rebuilt one run late (deferred)",
     set_as_published},
};

/// Of a motion that is not known.
Chosen recommended(Variant variant, std::span<const TriangleMesh> meshes) {
  set_recommended(variant);
  if (variant.query == "distance")
    return {variant,
            "distance queries cull by the volumes of single triangles, which rectangle swept "
            "spheres bound best"};
  const double elongated = elongation(meshes);
  std::ostringstream measured;
  measured << std::setprecision(3) << elongated;
  if (elongated < long_triangles)
    return {variant, "triangles are hardly longer than wide (" + measured.str() +
                         "): boxes along the mesh's axes, cut by a slab, fit them and cost least"};
  return {as<RecommendedOriented>(variant),
          "triangles are long (" + measured.str() +
              "): oriented boxes fit them, others are mostly empty"};
}

Chosen recommended(Variant variant, std::span<const TriangleMesh> meshes, const Trace& trace,
                   BroadPhase broad_phase) {
  const SampledFrames samples = samples_of(meshes, trace.frames);
  if (variant.query == "distance" || samples.frames.empty() || trace.pairs() == 0)
    return recommended(variant, meshes);
  const Trace sampled = part_of(trace, samples.frames);
  std::vector<std::vector<Pose>> poses(sampled.frames, std::vector<Pose>(sampled.objects));
  for (std::size_t k = 0; k < sampled.frames; ++k) sampled.poses(k, poses[k]);
  ReplayOptions options;
  options.count = Count::on, options.keep_answers = false, options.keep_series = true;
  // As it will be played.
  const bool pays = broad_phase == BroadPhase::where_it_pays && has_many_pairs(trace);
  options.broad_phase = pays || broad_phase == BroadPhase::on ? BroadPhase::on : BroadPhase::off;
  Chosen best;
  double least = std::numeric_limits<double>::infinity();
  std::ostringstream costs;
  for_each_candidate([&]<class Best>(const RecommendedCandidate<Best>& candidate) {
    const Variant tried = as<Best>(variant);
    // The program may have been configured without some volumes.
    if (wide_fan_out(tried.volume, tried.kernel) == 0) return;
    const UnitCosts& unit = candidate.costs(variant.query);
    const auto series = replay(meshes, sampled, tried, options).series;
    double cost = 0;
    for (std::size_t k = 0; k < series.size(); ++k)
      if (SampledFrames::counted(k))
        cost += unit(pairs_of_moved(poses[k - 1], poses[k]), series[k].front, series[k].n_v,
                     series[k].n_p);
    cost /= static_cast<double>(samples.size() * trace.pairs());
    costs << (costs.tellp() > 0 ? ", " : "") << candidate.name << ' ' << std::setprecision(3)
          << cost;
    if (cost < least) least = cost, best = {tried, std::string(candidate.name)};
  });
  if (best.reason.empty()) return recommended(variant, meshes);
  best.reason += " cost least in " + std::to_string(samples.frames.size()) +
                 " sampled frames, of " + std::to_string(trace.frames) +
                 " (expected ns per pair: " + costs.str() + ")";
  return best;
}

}  // namespace

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
  std::string names;
  for (const auto& each : list) {
    if (each.name == configuration) {
      each.set(variant);
      return variant;
    }
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  throw Unusable("--configuration " + std::string(configuration) +
                 ": unknown; available: " + names);
}

Chosen configured(Variant variant, std::string_view configuration,
                  std::span<const TriangleMesh> meshes, const Trace* trace,
                  BroadPhase broad_phase) {
  if (configuration != "recommended") return {configured(std::move(variant), configuration), ""};
  const auto start = Clock::now();
  Chosen chosen = trace ? recommended(std::move(variant), meshes, *trace, broad_phase)
                        : recommended(std::move(variant), meshes);
  chosen.seconds = seconds_since(start);
  return chosen;
}

}  // namespace bvlab
