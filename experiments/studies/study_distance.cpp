// SPDX-License-Identifier: BSD-3-Clause
/// Quinlan's relative error: what is promised, what is seen, and what it costs, for every volume on
/// the same traces. The truth is the distance at relative error 0.
#include <algorithm>
#include <cmath>

#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/scenes.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

StudyParameters parameters() {
  const NumberBounds lengths{0, 1e6};
  return {numbers_parameter("relative_errors", {0, 0.01, 0.1, 0.5}, {0}, "that are promised"),
          words_parameter("strategies", {"recursive"}, "see `bvlab list strategies`"),
          one(numbers_parameter("side", {4}, {1e-6, 1e6}, "of the cube, in radii of the body")),
          words_parameter("mesh", {"bunny"}, "meshes, NAME or NAME:POLYGONS: a scene for each"),
          one(wholes_parameter("polygons", {5000}, {1, most_polygons}, "triangles of each mesh")),
          one(wholes_parameter("objects", {9}, {1, 1000}, "bodies")),
          one(wholes_parameter("frames", {50}, {1, 1e6}, "frames, the start included")),
          one(wholes_parameter("seed", {1}, seeds, "of the random numbers")),
          one(numbers_parameter("step", {0.1}, lengths, "length of a step, in radii of the body")),
          one(numbers_parameter("degrees", {20}, {0, 180}, "angle of a step"))};
}

/// Of every strategy, each relative error.
std::vector<Variant> variants_of(const StudyDefinition& definition) {
  std::vector<Variant> variants;
  for (const auto& strategy : definition.words("strategies"))
    for (const double error : definition.numbers("relative_errors")) {
      Variant& variant = variants.emplace_back();
      variant.query = "distance", variant.strategy = strategy, variant.relative_error = error;
    }
  return variants;
}

void check_variants(const StudyDefinition& definition) {
  for (const Variant& variant : variants_of(definition)) bvlab::check(variant);
}

/// Bodies of one mesh wandering about.
std::pair<std::vector<TriangleMesh>, Trace> scene_of(const StudyDefinition& definition,
                                                     const std::string& name) {
  std::vector<TriangleMesh> meshes{mesh_of(definition, name)};
  const Extent extents[] = {extent_of(meshes[0])};
  RandomWalk walk;
  walk.objects = definition.whole("objects"), walk.frames = definition.whole("frames");
  walk.seed = definition.whole("seed"), walk.degrees = definition.number("degrees");
  walk.side = {definition.number("side"), Length::Unit::body};
  walk.step = {definition.number("step"), Length::Unit::body};
  walk.check();
  auto array = walk.generate(extents, {});
  return {std::move(meshes), {array.shape[0], array.shape[1], std::move(array.data)}};
}

struct Observed {
  double largest = 0, sum = 0;
  std::size_t below = 0, above = 0;  ///< answers outside of what is promised
};

/// A distance is right to 1e-14 of itself (triangle_distance.hpp). The search stops once no pair
/// can be nearer by more than a factor of 2^-45 (distance.hpp), in the truth and in the answer.
Observed compared(const std::vector<double>& answers, const std::vector<double>& truth,
                  double promised) {
  constexpr double grain = 1e-13;
  Observed observed;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double error = truth[i] > 0 ? answers[i] / truth[i] - 1 : answers[i] > 0 ? INFINITY : 0;
    observed.below += error < -grain;
    observed.above += error > promised + grain;
    observed.largest = std::max(observed.largest, error);
    observed.sum += error;
  }
  return observed;
}

void run(const StudyDefinition& definition, StudyRecord& record) {
  const auto variants = variants_of(definition);
  record.each(definition.words("mesh"), [&](const std::string& name) {
    const auto [meshes, trace] = scene_of(definition, name);
    Variant exact;
    exact.query = "distance";
    const auto truth = replay(meshes, trace, exact, {}).distances;
    const auto touching = std::count(truth.begin(), truth.end(), 0.0);
    std::vector<std::pair<Variant, ReplayResult>> cells;
    for (Variant variant : variants)
      for (const auto& volume : volumes()) {
        variant.volume = volume.name;
        ReplayOptions options;
        options.count = Count::on;
        cells.emplace_back(variant, replay(meshes, trace, variant, options));
      }
    record.interleave(cells.size(), [&](std::size_t k, unsigned repetition) {
      const auto& [cell, counted] = cells[k];
      const auto timed = replay(meshes, trace, cell, {});
      const Observed observed = compared(timed.distances, truth, cell.relative_error);
      record.add(cell.volume, cell.strategy, cell.relative_error, repetition, truth.size(),
                 touching, observed.largest, observed.sum / static_cast<double>(truth.size()),
                 observed.below + observed.above, counted.n_u, counted.n_v, counted.n_p,
                 nanoseconds(timed.seconds));
    });
  });
}

}  // namespace

const StudyKind studies::distance = {
    "distance",
    "the relative error of distances, promised and seen, against time",
    parameters,
    check_variants,
    {"mesh", "volume", "strategy", "relative_error", "repetition", "answers", "touching",
     "largest_error", "mean_error", "outside", "n_u", "n_v", "n_p", "time_ns"},
    run};

}  // namespace bvlab
