// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/configurations.hpp"

#include <iomanip>
#include <numbers>
#include <sstream>
#include <utility>

#include "experiments/files/joined.hpp"
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

/// Where the motion is not known. Margins save more than they cost wherever pairs are quiet: up to
/// nine tenths of the time from the roots, where they cost up to a third more if none is. Distances
/// are sought by the volumes of triangles, which rectangle swept spheres bound best.
void set_recommended(Variant& variant) {
  if (variant.query != "distance") {
    variant = variant_of<Recommended>(variant);
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
     "touching and contacts: the cheapest, builds included, in counted samples of the motion, "
     "of (1) slab-box, kernel siblings, built on-demand, leaves as large as a register; (2) "
     "obb, kernel mixed, built bottom-up, fit tight, leaves of 4; either of them with margins "
     "or recursive; with margins (3) slab-box, kernel siblings, built bottom-up, leaves of 4; "
     "(4) obb, kernel siblings, built bottom-up, fit tight, leaves of 8. In short runs, and "
     "where the motion is not known, (1) with margins; a World of long triangles changes to "
     "(2). distance: by the motion one of (1), (2), and rss in binary trees, frame body, "
     "built bottom-up, fit tight, leaves of 1, witness; the last where the motion is not "
     "known",
     set_recommended},
    {"as-published",
     "the talk's (Li and Chen 1998): spheres in binary trees, one triangle per leaf, and a "
     "separation list that is rebuilt one run late (deferred)",
     set_as_published},
};

/// What may be recommended, with its unit costs and what its trees cost (recommended_for.hpp).
struct Option {
  Variant variant;
  std::string_view name;
  double build;
  UnitCosts unit;
};
std::vector<Option> options_for(const Variant& variant) {
  std::vector<Option> options;
  for_each_candidate([&]<class Best>(const RecommendedCandidate<Best>& candidate) {
    options.push_back({variant_of<Best>(variant), candidate.name, candidate.build,
                       candidate.costs(variant.query)});
  });
  // The program may have been configured without some volumes.
  std::erase_if(options, [](const Option& option) {
    return wide_fan_out(option.variant.volume, option.variant.kernel) == 0;
  });
  return options;
}

/// Whether the program has it: it may have been configured without some volumes.
template <class Best>
bool is_compiled() {
  return wide_fan_out(Best::Volume::name, Best::Kernel::name) > 0;
}

/// Of a motion that is not known.
Chosen recommended(Variant variant) {
  set_recommended(variant);
  if (variant.query == "distance")
    return {variant,
            "distance queries cull by the volumes of single triangles, which rectangle swept "
            "spheres bound best"};
  return {variant, "slab-boxes, made on demand: no other trees cost less before the first frame"};
}

/// How far a body moves in a frame, in the mean: in radii of its mesh, and in radians.
double mean_motion(std::span<const TriangleMesh> meshes, const Trace& trace) {
  std::vector<double> radii;
  for (const auto& mesh : meshes) radii.push_back(MeshSphere(mesh).radius);
  const std::size_t stride = 1 + trace.frames / 200;
  std::vector<Pose> before(trace.objects), now(trace.objects);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t frame = 1; frame < trace.frames; frame += stride) {
    trace.poses(frame - 1, before), trace.poses(frame, now);
    for (std::size_t i = 0; i < trace.objects; ++i, ++count)
      sum += (now[i].translation - before[i].translation).norm() / radii[i % radii.size()] +
             (now[i].rotation - before[i].rotation).norm() / std::numbers::sqrt2;
  }
  return count ? sum / static_cast<double>(count) : 0;
}

/// Distances of bunnies of 500 triangles take 30 us a pair with the trees that are built fastest
/// and 15 with others, whose builds take 7 us a triangle more. Of these, oriented boxes with
/// margins take .6 of the time of rectangle swept spheres at .001 radii and .1 degrees a frame, .85
/// at .003 and .3, 1.2 at .06 and 1.
Chosen recommended_distances(Variant variant, std::span<const TriangleMesh> meshes,
                             const Trace& trace) {
  constexpr double slow = 0.007;
  if (2 * trace.frames * trace.pairs() < triangles_of(meshes) && is_compiled<Recommended>())
    return {variant_of<Recommended>(variant),
            "the run is too short to repay trees that take longer to build"};
  const double moved = mean_motion(meshes, trace);
  std::ostringstream measured;
  measured << std::setprecision(3) << moved;
  if (moved < slow && is_compiled<RecommendedOriented>())
    return {variant_of<RecommendedOriented>(variant),
            "bodies move slowly (" + measured.str() +
                " radii and radians a frame): margins on oriented "
                "boxes skip most tests"};
  Chosen chosen = recommended(std::move(variant));
  chosen.reason += "; bodies move fast (" + measured.str() + " radii and radians a frame)";
  return chosen;
}

Chosen recommended(Variant variant, std::span<const TriangleMesh> meshes, const Trace& trace,
                   BroadPhase broad_phase, KeptTrees& trees) {
  if (variant.query == "distance" && trace.pairs() > 0)
    return recommended_distances(std::move(variant), meshes, trace);
  const SampledFrames samples(trace.frames, trace.pairs());
  const std::vector<Option> all = options_for(variant);
  if (all.empty() || trace.pairs() == 0) return recommended(variant);
  RunCosts costs(triangles_of(meshes), trace.frames * trace.pairs());
  Chosen best{all[0].variant, std::string(all[0].name) + ": the run is too short to repay samples"};
  if (samples.frames.empty()) return best;
  const Trace sampled = part_of(trace, samples.frames);
  std::vector<std::vector<Pose>> poses(sampled.frames, std::vector<Pose>(sampled.objects));
  for (std::size_t k = 0; k < sampled.frames; ++k) sampled.poses(k, poses[k]);
  ReplayOptions options;
  options.count = Count::on, options.keep_answers = false, options.keep_series = true;
  options.trees = &trees;
  // As it will be played.
  const bool pays = broad_phase == BroadPhase::where_it_pays && has_many_pairs(trace);
  options.broad_phase = pays || broad_phase == BroadPhase::on ? BroadPhase::on : BroadPhase::off;
  std::ostringstream tried;
  for (const Option& option : all) {
    if (!costs.may_pay(option.build)) continue;
    const auto series = replay(meshes, sampled, option.variant, options).series;
    double cost = 0;
    for (std::size_t k = 0; k < series.size(); ++k)
      if (SampledFrames::counted(k))
        cost += option.unit(pairs_of_moved(poses[k - 1], poses[k]), series[k].front, series[k].n_v,
                            series[k].n_p);
    cost /= static_cast<double>(samples.size() * trace.pairs());
    tried << (tried.tellp() > 0 ? ", " : "") << option.name << ' ' << std::setprecision(3) << cost;
    if (costs.is_best(option.build, cost)) best = {option.variant, std::string(option.name)};
  }
  if (tried.tellp() > 0)
    best.reason += " cost least, builds included, by " + std::to_string(samples.frames.size()) +
                   " sampled frames, of " + std::to_string(trace.frames) +
                   " (expected ns per pair: " + tried.str() + ")";
  return best;
}

}  // namespace

std::optional<LaterChoice> later_choice(const Variant& variant,
                                        std::span<const TriangleMesh> meshes) {
  if (variant.query == "distance" || !is_compiled<RecommendedOriented>() ||
      elongation(meshes) < long_triangles)
    return std::nullopt;
  constexpr double build =
      std::get<RecommendedCandidate<RecommendedOriented>>(recommended_candidates).build;
  return LaterChoice{variant_of<RecommendedOriented>(variant),
                     1e-9 * build * static_cast<double>(triangles_of(meshes))};
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

Chosen configured(Variant variant, std::string_view configuration,
                  std::span<const TriangleMesh> meshes, const Trace* trace,
                  BroadPhase broad_phase) {
  if (configuration != "recommended") return {configured(std::move(variant), configuration), ""};
  const auto start = Clock::now();
  auto trees = std::make_shared<KeptTrees>();
  Chosen chosen = trace ? recommended(std::move(variant), meshes, *trace, broad_phase, *trees)
                        : recommended(std::move(variant));
  // Trees of what was not chosen go; those of what was are the run's.
  std::erase_if(*trees,
                [of = trees_of(chosen.variant)](const auto& each) { return each.first != of; });
  chosen.seconds = seconds_since(start);
  for (const auto& [name, each] : *trees) chosen.seconds -= each.seconds;
  chosen.trees = std::move(trees);
  return chosen;
}

}  // namespace bvlab
