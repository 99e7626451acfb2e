// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/replay_budgeted.hpp"

#include <algorithm>
#include <memory>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "traversal/budgeted.hpp"
#include "traversal/queries/touching.hpp"

namespace bvlab {
namespace {

void note(BudgetedResult& result, const BudgetedAnswer& answer) {
  ++(answer.verdict == BudgetVerdict::touching ? result.touching
     : answer.verdict == BudgetVerdict::apart  ? result.apart
                                               : result.unknown);
  result.deepest = std::max(result.deepest, answer.deepest);
  result.mean_deepest += answer.deepest;
  result.known.push_back(static_cast<std::uint8_t>(answer.verdict));
  result.bounds.push_back(answer.deepest);
}

}  // namespace

BudgetedResult replay_budgeted(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, std::uint64_t budget, Count count) {
  check(variant);
  if (variant.kernel != "gathered")
    throw Unusable("--kernel " + variant.kernel +
                   ": not for answers within a budget; there is gathered");
  BudgetedResult result;
  const TriangleTest test = triangle_test(variant.precision);
  auto start = Clock::now();
  const auto hierarchies = volume_entry(variant.volume).hierarchies(meshes, variant);
  AnyBodies<Touching> bodies(bodies_entry<Touching>(variant.volume)
                                 .bodies(*hierarchies, trace.objects, frame_of(variant)));
  std::vector<PatchSizes> sizes;
  for (std::size_t m = 0; m < meshes.size() && m < bodies.size(); ++m)
    sizes.emplace_back(meshes[m], bodies[m].tree());
  result.build_seconds = seconds_since(start);
  const auto pairs = object_pairs(trace);
  result.known.reserve(trace.frames * pairs.size());
  result.bounds.reserve(trace.frames * pairs.size());
  PosesInTurn poses_in_turn(trace);
  Budgeted<BodiesInside<Touching>::W> ask;
  Vec3<double> origin;
  Counting counter;
  start = Clock::now();
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    const auto poses = poses_in_turn.at(frame);
    if (frame == 0) origin = centre_of(poses, bodies);
    bodies.move(poses, origin);
    for (const auto& [i, j] : pairs)
      note(result, ask(bodies[i], sizes[i % meshes.size()], bodies[j], sizes[j % meshes.size()],
                       bodies.tests_between(), budget, test, counter));
    if (frame == 0) result.first_seconds = seconds_since(start);
  }
  result.seconds = seconds_since(start);
  if (count == Count::on)
    result.n_u = counter.n_u, result.n_v = counter.n_v, result.n_p = counter.n_p;
  if (!result.bounds.empty()) result.mean_deepest /= static_cast<double>(result.bounds.size());
  return result;
}

}  // namespace bvlab
