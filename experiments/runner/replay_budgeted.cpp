// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/replay_budgeted.hpp"

#include "experiments/runner/hierarchies_of.hpp"
#include "experiments/runner/replay_shares.hpp"
#include "experiments/runner/triangle_test.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/budgeted.hpp"
#include "traversal/counters.hpp"

namespace bvlab {
namespace {

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
  const auto hierarchies = hierarchies_of<V>(meshes, variant);
  std::vector<PatchSizes> sizes;
  for (std::size_t m = 0; m < meshes.size(); ++m) sizes.emplace_back(meshes[m], hierarchies[m]);
  std::vector<Body<V>> bodies;
  for (std::size_t i = 0; i < trace.objects; ++i)
    bodies.emplace_back(meshes[i % meshes.size()], hierarchies[i % meshes.size()]);
  result.build_seconds = seconds_since(start);
  const auto pairs = all_object_pairs(static_cast<std::uint32_t>(trace.objects));
  result.known.reserve(trace.frames * pairs.size());
  result.bounds.reserve(trace.frames * pairs.size());
  std::vector<Pose> poses(trace.objects);
  Budgeted<NativeBatch<typename V::scalar>, V> ask;
  Counter counter;
  Vec3<double> origin;
  start = Clock::now();
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    if (frame == 0) origin = middle_of(poses);
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].move(poses[i], origin);
    for (const auto& [i, j] : pairs)
      note(result, ask(bodies[i], sizes[i % meshes.size()], bodies[j], sizes[j % meshes.size()],
                       budget, test, counter));
    if (frame == 0) result.first_seconds = seconds_since(start);
  }
  result.seconds = seconds_since(start);
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
