// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for given meshes, or for given meshes and their motion, for the
/// queries touching and contacts.
///
/// There are three candidate configurations. Which one is fastest depends on the motion as much as
/// on the meshes: where surfaces run closely along each other, oriented boxes win on any mesh, and
/// no property of meshes that was tried predicts it. So where the motion is known, all candidates
/// replay short samples of it, and the expected cost of a pair
///
///     C + N_f C_f + N_v C_v + N_p C_p
///
/// with the N counted on the samples and the C below, decides (N_f: entries of fronts). Counts do
/// not depend on the machine's load, so the choice is repeatable. Where the motion is unknown, the
/// shape of the triangles decides.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/recommended.hpp"
#include "traversal/wide/mixed_kernel.hpp"

namespace bvlab {

/// Oriented boxes, which fit best and cost most: for meshes of long triangles, as in models of
/// plates and beams, and for surfaces that run closely along each other.
using RecommendedOriented =
    MarginsOver<Obb<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::tight, 4>;

/// Slab-boxes in smaller leaves, for bodies that come near each other at few triangles.
using RecommendedSmallLeaves = MarginsOver<SlabBox<float>, recommended_fan_out, SiblingsKernel,
                                           builds::BottomUpLocal, Fit::published, 4>;

/// The costs of a pair of bodies (C), a visited entry of a front (C_f), a test of two volumes (C_v)
/// and one of two triangles (C_p), in nanoseconds on the machine of record real-motions; posing is
/// part of C_v. Only their ratios matter.
struct UnitCosts {
  double pair, entry, volume, triangle;

  /// `front` is the number of entries of all fronts.
  double operator()(std::size_t pairs, std::size_t front, std::uint64_t n_v,
                    std::uint64_t n_p) const {
    return static_cast<double>(pairs) * pair + static_cast<double>(front) * entry +
           static_cast<double>(n_v) * volume + static_cast<double>(n_p) * triangle;
  }
};

/// A configuration that may be recommended, and its unit costs.
template <class Best>
struct RecommendedCandidate {
  std::string_view name;
  UnitCosts touching, contacts;

  /// The unit costs for a query, by its name.
  const UnitCosts& costs(std::string_view query) const {
    return query == Touching::name ? touching : contacts;
  }
};

/// Calls `what` with each candidate. Unit costs were fitted by least squares of relative error: of
/// touching to the times of 18 motions, planning problems and bunnies of 500 and 8000 polygons in
/// five kinds of motion; of contacts to 40 motions of the five meshes of record peers-meshes. There
/// N_v and N_p grow together; C_v was set to what a step costs by a profile, and C_p fitted.
template <class Do>
void for_each_candidate(Do&& what) {
  what(RecommendedCandidate<Recommended>{"slab-boxes", {15, 5.2, 5.2, 1.6}, {50, 5.2, 3.0, 3.2}});
  what(RecommendedCandidate<RecommendedSmallLeaves>{
      "slab-boxes in small leaves", {14, 6.2, 6.5, 5.3}, {50, 6.2, 6.5, 4.8}});
  what(RecommendedCandidate<RecommendedOriented>{
      "oriented boxes", {18, 10.1, 5.7, 8.8}, {50, 10.1, 6.5, 4.2}});
}

/// The frames of a motion that are replayed for the choice: up to sixteen runs of `run` consecutive
/// frames, evenly spread, at most a quarter of the motion. None where it has fewer than 24.
struct SampledFrames {
  static constexpr std::size_t run = 6, uncounted = 3, most_runs = 16;
  std::vector<std::size_t> frames;

  explicit SampledFrames(std::size_t length) {
    const std::size_t runs = std::min(most_runs, length / (4 * run));
    for (std::size_t i = 0; i < runs; ++i)
      for (std::size_t k = 0; k < run; ++k)
        frames.push_back((2 * i + 1) * length / (2 * runs) - run / 2 + k);
  }
  /// Whether frames[k] is counted. The first frames of a run are not: there bodies have jumped and
  /// fronts start anew.
  static bool counted(std::size_t k) { return k % run >= uncounted; }
  /// The number of counted frames.
  std::size_t size() const { return frames.size() / run * (run - uncounted); }
};
/// The sampled frames for a motion of `frames` frames. None where the meshes have more than 200 000
/// triangles in all, since building hierarchies for three candidates would take too long.
inline SampledFrames samples_of(std::span<const TriangleMesh> meshes, std::size_t frames) {
  std::size_t triangles = 0;
  for (const auto& mesh : meshes) triangles += mesh.triangles.size();
  return SampledFrames(triangles > 200'000 ? 0 : frames);
}

/// Calls `visit` with std::type_identity of the candidate for these meshes in unknown motion, and
/// returns what it returns. O(triangles). For example, of bodies that all have one mesh:
///
///     with_recommended(std::span(&mesh, 1), [&]<class Best>(std::type_identity<Best>) {
///       const auto tree = Best::hierarchy(mesh);
///       const std::vector<typename Best::Shape> shapes(bodies, {&mesh, &tree});
///       World<typename Best::Pairs> world{typename Best::Pairs(shapes)};
///     });
template <class Visit>
decltype(auto) with_recommended(std::span<const TriangleMesh> meshes, Visit&& visit) {
  if (elongation(meshes) < long_triangles) return visit(std::type_identity<Recommended>());
  return visit(std::type_identity<RecommendedOriented>());
}

/// The expected cost of the counted samples with one candidate, in the unit of its unit costs.
/// samples[k] has the poses of all bodies; body i has mesh i modulo the number of meshes.
/// `make_query(p)` returns the query of pair p, as for WidePairs::frame.
template <class Best, class MakeQuery>
double expected_cost(std::span<const TriangleMesh> meshes,
                     std::span<const std::vector<Pose>> samples, const UnitCosts& costs,
                     MakeQuery&& make_query) {
  if (samples.empty()) return 0;
  std::vector<typename Best::Hierarchy> hierarchies;
  for (const auto& mesh : meshes) hierarchies.push_back(Best::hierarchy(mesh));
  std::vector<typename Best::Shape> shapes;
  for (std::size_t i = 0; i < samples[0].size(); ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  typename Best::Pairs pairs(shapes, all_object_pairs(static_cast<std::uint32_t>(shapes.size())));
  double cost = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Counting counts;
    pairs.frame(samples[k], counts, make_query, [](auto&&...) {});
    if (SampledFrames::counted(k))
      cost += costs(pairs.pairs().size(), pairs.front_size(), counts.n_v, counts.n_p);
  }
  return cost;
}

/// `with_recommended` for a motion that is known: `frames[k]` has the poses of all bodies in frame
/// k. Builds a hierarchy of each mesh for each candidate.
template <class MakeQuery, class Visit>
decltype(auto) with_recommended(std::span<const TriangleMesh> meshes,
                                std::span<const std::vector<Pose>> frames, MakeQuery&& make_query,
                                Visit&& visit) {
  using Query = std::remove_cvref_t<decltype(make_query(std::size_t{0}))>;
  std::vector<std::vector<Pose>> samples;
  for (const std::size_t frame : samples_of(meshes, frames.size()).frames)
    samples.push_back(frames[frame]);
  if (samples.empty()) return with_recommended(meshes, visit);
  std::vector<double> cost;
  for_each_candidate([&]<class Best>(const RecommendedCandidate<Best>& candidate) {
    cost.push_back(expected_cost<Best>(meshes, samples, candidate.costs(Query::name), make_query));
  });
  const auto least = std::min_element(cost.begin(), cost.end()) - cost.begin();
  if (least == 0) return visit(std::type_identity<Recommended>());
  if (least == 1) return visit(std::type_identity<RecommendedSmallLeaves>());
  return visit(std::type_identity<RecommendedOriented>());
}

}  // namespace bvlab
