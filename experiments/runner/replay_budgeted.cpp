// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/replay_budgeted.hpp"

#include <chrono>

#include "experiments/runner/hierarchies_of.hpp"
#include "experiments/runner/triangle_test.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/budgeted.hpp"
#include "traversal/counters.hpp"

namespace bvlab {
namespace {

template <class T>
using Lanes = Batch<T, std::max(native_width<T>, 4)>;

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The middle of the first frame's box of translations: volumes are posed relative to it.
Vec3<double> middle(std::span<const Pose> poses) {
  Vec3<double> low = poses[0].translation, high = low;
  for (const auto& pose : poses)
    low = low.cwiseMin(pose.translation), high = high.cwiseMax(pose.translation);
  return low / 2 + high / 2;
}

template <class V>
struct Model {
  Hierarchy<V> hierarchy;
  PatchSizes sizes;
  Model(const TriangleMesh& mesh, const Topology& topology, Fit fit)
      : hierarchy(mesh, topology, fit), sizes(mesh, hierarchy) {}
};

void note(BudgetedResult& result, const BudgetedAnswer& answer) {
  ++(answer.known == Known::touching ? result.touching
     : answer.known == Known::apart  ? result.apart
                                     : result.unknown);
  result.deepest = std::max(result.deepest, answer.deepest);
  result.mean_deepest += answer.deepest;
  result.known.push_back(static_cast<std::uint8_t>(answer.known));
  result.bounds.push_back(answer.deepest);
}

template <class V, class Counter>
void play(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
          std::uint64_t budget, TriangleTest test, BudgetedResult& result) {
  auto start = Clock::now();
  std::vector<Model<V>> models;
  Builds::with(variant.build, [&]<class Build>(std::type_identity<Build>) {
    for (const auto& mesh : meshes)
      models.emplace_back(mesh, Build::topology(mesh, variant.leaf_size), fit_of(variant));
  });
  std::vector<Body<V>> bodies;
  for (std::size_t i = 0; i < trace.objects; ++i)
    bodies.emplace_back(meshes[i % meshes.size()], models[i % meshes.size()].hierarchy);
  result.build_seconds = since(start);
  const auto pairs = all_object_pairs(static_cast<std::uint32_t>(trace.objects));
  result.known.reserve(trace.frames * pairs.size());
  result.bounds.reserve(trace.frames * pairs.size());
  std::vector<Pose> poses(trace.objects);
  Budgeted<Lanes<typename V::scalar>, V> ask;
  Counter counter;
  Vec3<double> origin;
  start = Clock::now();
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    if (frame == 0 && !poses.empty()) origin = middle(poses);
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].move(poses[i], origin);
    for (const auto& [i, j] : pairs)
      note(result, ask(bodies[i], models[i % meshes.size()].sizes, bodies[j],
                       models[j % meshes.size()].sizes, budget, test, counter));
    if (frame == 0) result.first_seconds = since(start);
  }
  result.seconds = since(start);
  if (!result.bounds.empty()) result.mean_deepest /= static_cast<double>(result.bounds.size());
  result.n_u = counter.n_u, result.n_v = counter.n_v, result.n_p = counter.n_p;
}

}  // namespace

BudgetedResult replay_budgeted(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, std::uint64_t budget, Count count) {
  check(variant);
  BudgetedResult result;
  const TriangleTest test = triangle_test(variant.precision);
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    if (count == Count::on)
      play<V, Counting>(meshes, trace, variant, budget, test, result);
    else
      play<V, NotCounting>(meshes, trace, variant, budget, test, result);
  });
  return result;
}

}  // namespace bvlab
