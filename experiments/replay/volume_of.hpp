// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a volume whatever is asked of it: its hierarchies, its tightness, and
/// answers within a budget.
#pragma once

#include <algorithm>

#include "experiments/replay/drawn_volume.hpp"
#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/budgeted.hpp"
#include "traversal/counters.hpp"

namespace bvlab {

namespace detail {

inline void note(BudgetedResult& result, const BudgetedAnswer& answer) {
  ++(answer.verdict == BudgetVerdict::touching ? result.touching
     : answer.verdict == BudgetVerdict::apart  ? result.apart
                                               : result.unknown);
  result.deepest = std::max(result.deepest, answer.deepest);
  result.mean_deepest += answer.deepest;
  result.known.push_back(static_cast<std::uint8_t>(answer.verdict));
  result.bounds.push_back(answer.deepest);
}

/// Counted by the traversal itself, so that one version serves both ways to count.
template <BoundingVolume V>
BudgetedResult play_budgeted(std::span<const TriangleMesh> meshes, const Trace& trace,
                             const Variant& variant, std::uint64_t budget, Count count) {
  BudgetedResult result;
  const TriangleTest test = triangle_test(variant.precision);
  auto start = Clock::now();
  const HierarchiesOf<V> hierarchies(meshes, variant);
  std::vector<PatchSizes> sizes;
  for (std::size_t m = 0; m < meshes.size(); ++m) sizes.emplace_back(meshes[m], hierarchies[m]);
  Bodies<NativeBatch<typename V::scalar>, V> bodies(hierarchies.shapes(trace.objects),
                                                    frame_of(variant));
  result.build_seconds = seconds_since(start);
  const auto pairs = object_pairs(trace);
  result.known.reserve(trace.frames * pairs.size());
  result.bounds.reserve(trace.frames * pairs.size());
  PosesInTurn poses_in_turn(trace);
  Budgeted<NativeBatch<typename V::scalar>, V> ask;
  const auto play = [&](auto& counter) {
    Vec3<double> origin;
    start = Clock::now();
    for (std::size_t frame = 0; frame < trace.frames; ++frame) {
      const auto poses = poses_in_turn.at(frame);
      if (frame == 0) origin = centre_of(poses, bodies);
      bodies.move(poses, origin);
      for (const auto& [i, j] : pairs)
        note(result, ask(bodies[i], sizes[i % meshes.size()], bodies[j], sizes[j % meshes.size()],
                         budget, test, counter));
      if (frame == 0) result.first_seconds = seconds_since(start);
    }
    result.seconds = seconds_since(start);
    result.n_u = counter.n_u, result.n_v = counter.n_v, result.n_p = counter.n_p;
  };
  if (count == Count::on) {
    Counting counter;
    play(counter);
  } else {
    NotCounting counter;
    play(counter);
  }
  if (!result.bounds.empty()) result.mean_deepest /= static_cast<double>(result.bounds.size());
  return result;
}

template <BoundingVolume V>
std::vector<double> gaps_of(const TriangleMesh& mesh, const Topology& topology, Fit fit,
                            std::span<const GapQuestion> questions) {
  const Hierarchy<V> hierarchy(mesh, topology, fit);
  std::vector<double> gaps;
  for (const auto& [node, at] : questions) {
    // Both stand where they are, with the margins that a pose brings along.
    const Vec3<double> local = at - hierarchy.extent().origin;
    const double reach = std::max(hierarchy.extent().reach, 2 * local.norm());
    const bvlab::PlacementOf<V> here(Pose{}, Vec3<double>::Zero(), reach);
    const Vec3<double> point[] = {local};
    gaps.push_back(gap(posed(hierarchy.volume(node), here),
                       posed(V::enclosing(std::span<const Vec3<double>>(point)), here)));
  }
  return gaps;
}

template <BoundingVolume V>
std::vector<float> drawn_of(const AnyHierarchies& hierarchies, std::size_t mesh,
                            std::span<const std::uint32_t> nodes) {
  const auto& hierarchy = static_cast<const HierarchiesOf<V>&>(hierarchies)[mesh];
  std::vector<float> all;
  for (const auto node : nodes) {
    const auto numbers = drawn_numbers(hierarchy.volume(node));
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return all;
}

}  // namespace detail

template <BoundingVolume V>
constexpr VolumeEntry volume_of() {
  return {
      V::name,
      V::description,
      FittedTightly<V>,
      PlacedRelatively<V>,
      [](std::span<const TriangleMesh> meshes, const Variant& variant) {
        return std::unique_ptr<AnyHierarchies>(std::make_unique<HierarchiesOf<V>>(meshes, variant));
      },
      detail::gaps_of<V>,
      detail::play_budgeted<V>,
      drawn_as<V>(),
      detail::drawn_of<V>};
}

}  // namespace bvlab
