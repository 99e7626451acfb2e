// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for given meshes, or for given meshes and their motion, for the
/// queries touching and contacts.
///
/// There are four kinds of trees, with margins or (two of them) from the roots in every frame: six
/// candidates. Which one is fastest depends on the motion as much as on the meshes: where
/// surfaces run closely along each other, oriented boxes win on any mesh; where hardly an answer
/// outlasts a frame, margins cost more than they save; and no property of meshes that was tried
/// predicts either. So where the motion is known, all candidates replay short samples of it, and
/// the expected cost of a pair
///
///     C + N_f C_f + N_v C_v + N_p C_p
///
/// with the N counted on the samples and the C below, decides (N_f: entries of fronts), together
/// with the cost of building the trees. The first candidates' trees are made on demand, and cost
/// next to nothing. Others are tried only if the run can repay building them, by what a pair was
/// seen to cost so far; short runs are not sampled at all. Counts do not depend on the load of the
/// machine, so the choice is repeatable. Where the motion is unknown, the shape and the number of
/// the triangles decide, and margins are kept.
#pragma once

#include <algorithm>
#include <any>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/recommended.hpp"
#include "traversal/wide/mixed_kernel.hpp"

namespace bvlab {

/// Oriented boxes, which fit best and cost most: for meshes of long triangles, as in models of
/// plates and beams, and for surfaces that run closely along each other.
using RecommendedOriented =
    MarginsOver<WideTrees<Obb<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::tight, 4>>;

/// Oriented boxes, one against as many as a register has lanes: for surfaces that follow each other
/// closely throughout a motion, as in narrow passages.
using RecommendedWideOriented =
    MarginsOver<WideTrees<Obb<float>, native_fan_out<float>, SiblingsKernel, builds::BottomUpLocal,
                          Fit::tight, std::min(8, native_fan_out<float>)>>;

/// Slab-boxes in smaller leaves, for bodies that come near each other at few triangles.
using RecommendedSmallLeaves =
    MarginsOver<WideTrees<SlabBox<float>, native_fan_out<float>, SiblingsKernel,
                          builds::BottomUpLocal, Fit::published, 4>>;

/// Slab-boxes and oriented boxes from the roots: for bodies so fast, or so often in contact,
/// that hardly an answer outlasts a frame.
using RecommendedRoots = RootsOf<Recommended::Trees>;
using RecommendedOrientedRoots = RootsOf<RecommendedOriented::Trees>;

/// The costs of a pair of bodies (C), an entry of a front (C_f), a test of two volumes (C_v)
/// and one of two triangles (C_p), about nanoseconds on the machine of record real-motions; posing
/// is part of C_v. Only their ratios matter.
struct UnitCosts {
  double pair, entry, volume, triangle;

  /// `pairs` as in pairs_of_moved; `front` is the number of entries of all fronts.
  double operator()(std::size_t pairs, std::size_t front, std::uint64_t n_v,
                    std::uint64_t n_p) const {
    return static_cast<double>(pairs) * pair + static_cast<double>(front) * entry +
           static_cast<double>(n_v) * volume + static_cast<double>(n_p) * triangle;
  }
};

/// How many pairs are charged with C in a frame: those with a moved body, but at most four for each
/// moved body. Most of C is spent on bodies; it was fitted to scenes of nine bodies (36 pairs) and
/// of two (one pair).
inline std::size_t pairs_of_moved(std::span<const Pose> before, std::span<const Pose> now) {
  std::size_t moved = 0;
  for (std::size_t i = 0; i < now.size(); ++i) moved += !(now[i] == before[i]);
  const std::size_t still = now.size() - moved;
  return std::min(moved * still + moved * (moved - 1) / 2, 4 * moved);
}

/// A configuration that may be recommended, and its unit costs.
template <class Best>
struct RecommendedCandidate {
  using Configuration = Best;
  std::string_view name;
  double build;  ///< of a triangle's share of the trees, in nanoseconds
  UnitCosts touching, contacts;

  /// The unit costs for a query, by its name.
  const UnitCosts& costs(std::string_view query) const {
    return query == Touching::name ? touching : contacts;
  }
};

/// What a tree that is made on demand costs before anything of it is made, in nanoseconds a
/// triangle.
inline constexpr double on_demand = 50;

/// The candidates; one from the roots follows the one with the same trees. Small leaves from the
/// roots never cost least.
///
/// Unit costs were fitted by experiments/fit_candidates to definition recommended-costs (planning
/// problems, bunnies of 500 to 8000 polygons, three more meshes) with seeds 21, 77, 79 and 97: 110
/// motions for touching, 60 for contacts. The fit weights the ratios between the best candidates
/// of each motion more than the times themselves, so these are not the costs of single tests. The
/// chosen candidate takes 1.02 times the time of the best in the mean of these motions; fitted to
/// three of the seeds, 1.03 times in the mean of those of the fourth.
///
/// Processors differ: none of the unit costs that were fitted to two of different makers came
/// within a tenth of the best on all motions of both.
inline constexpr std::tuple recommended_candidates{
    RecommendedCandidate<Recommended>{
        "slab-boxes", on_demand, {35.3, 7.91, 7.98, 1.71}, {53.9, 1.69, 3.2, 5.17}},
    RecommendedCandidate<RecommendedRoots>{
        "slab-boxes from the roots", on_demand, {1.87, 0, 5.21, 3.42}, {4.14, 0, 2.85, 4.35}},
    RecommendedCandidate<RecommendedSmallLeaves>{
        "slab-boxes in small leaves", 1400, {48.8, 1.66, 8.99, 0.622}, {59.8, 0.786, 7.03, 14}},
    RecommendedCandidate<RecommendedOriented>{
        "oriented boxes", 8000, {38.3, 3.99, 8.43, 5.14}, {52.8, 2.17, 10.2, 4.68}},
    RecommendedCandidate<RecommendedOrientedRoots>{
        "oriented boxes from the roots", 8000, {1.74, 0, 10.2, 1.27}, {33.7, 0, 9.05, 5.56}},
    RecommendedCandidate<RecommendedWideOriented>{
        "wide oriented boxes", 8000, {65.9, 1.71, 8, 11.1}, {2.74, 3.05, 7.35, 12.6}}};

/// Which candidates a run is worth trying: the expected costs of the whole run, in nanoseconds, its
/// builds included.
class RunCosts {
 public:
  /// `triangles` of all meshes together, `pairs` of all frames together.
  RunCosts(std::size_t triangles, std::size_t pairs)
      : triangles_(static_cast<double>(triangles)), pairs_(static_cast<double>(pairs)) {}

  /// Whether a candidate with such a build is worth trying: whether it would still be cheaper than
  /// the best so far if it saved most of what a pair costs, and its trees were built twice. The
  /// first one is.
  bool may_pay(double build) const {
    constexpr double most_saved = 0.7;
    return !is_known_ || 2 * build * triangles_ < most_saved * pairs_ * pair_;
  }
  /// Notes what a pair is expected to cost with a candidate; returns whether it is the best so far.
  bool is_best(double build, double pair) {
    const double all = build * triangles_ + pairs_ * pair;
    if (is_known_ && !(all < all_)) return false;
    is_known_ = true, pair_ = pair, all_ = all;
    return true;
  }

 private:
  double triangles_, pairs_, pair_ = 0, all_ = 0;
  bool is_known_ = false;
};
inline std::size_t triangles_of(std::span<const TriangleMesh> meshes) {
  std::size_t triangles = 0;
  for (const auto& mesh : meshes) triangles += mesh.triangles.size();
  return triangles;
}

/// Calls `what` with each candidate, in order.
template <class Do>
void for_each_candidate(Do&& what) {
  std::apply([&](const auto&... candidate) { (what(candidate), ...); }, recommended_candidates);
}

/// Calls `visit` with std::type_identity of the configuration of candidate `k`, and returns what it
/// returns.
template <std::size_t first = 0, class Visit>
decltype(auto) with_candidate(std::size_t k, Visit&& visit) {
  using Candidates = std::remove_const_t<decltype(recommended_candidates)>;
  if constexpr (first + 1 < std::tuple_size_v<Candidates>)
    if (k != first) return with_candidate<first + 1>(k, visit);
  return visit(
      std::type_identity<typename std::tuple_element_t<first, Candidates>::Configuration>());
}

/// The frames of a motion that are replayed for the choice: up to ten runs of `run` consecutive
/// frames, evenly spread, at most a twentieth of the motion. None where it has fewer than 200
/// frames or, in all of them together, 2000 pairs of bodies: such a run may end before samples
/// have.
struct SampledFrames {
  static constexpr std::size_t run = 10, uncounted = 6, most_runs = 10, share = 20, few = 2000;
  std::vector<std::size_t> frames;

  /// Of a motion of so many frames, of so many pairs of bodies.
  SampledFrames(std::size_t length, std::size_t pairs) {
    const std::size_t runs = length * pairs < few ? 0 : std::min(most_runs, length / (share * run));
    for (std::size_t i = 0; i < runs; ++i)
      for (std::size_t k = 0; k < run; ++k)
        frames.push_back((2 * i + 1) * length / (2 * runs) - run / 2 + k);
  }
  /// Whether frames[k] is counted. The first frames of a run are not: there bodies have jumped, and
  /// fronts are written and swept for the first time.
  static bool counted(std::size_t k) { return k % run >= uncounted; }
  /// The number of counted frames.
  std::size_t size() const { return frames.size() / run * (run - uncounted); }
};
/// Meshes of more triangles get slab-boxes in unknown motion, whatever their shape: the trees of
/// oriented boxes take over 50 ms.
inline constexpr std::size_t many_triangles = 6000;

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
  if (triangles_of(meshes) <= many_triangles && elongation(meshes) >= long_triangles)
    return visit(std::type_identity<RecommendedOriented>());
  return visit(std::type_identity<Recommended>());
}

/// One hierarchy for each mesh. A type for each kind of trees: two kinds may have the same
/// Hierarchy.
template <class Trees>
struct HierarchiesBy {
  std::vector<typename Trees::Hierarchy> of_mesh;

  explicit HierarchiesBy(std::span<const TriangleMesh> meshes) {
    for (const auto& mesh : meshes) of_mesh.push_back(Trees::hierarchy(mesh));
  }
};

/// The expected cost of the counted samples with one candidate, in the unit of its unit costs.
/// samples[k] has the poses of all bodies. `make_query(p)` returns the query of pair p, as for
/// AllPairsOf::frame.
template <class Best, class MakeQuery>
double expected_cost(std::span<const typename Best::Shape> shapes,
                     std::span<const std::vector<Pose>> samples, const UnitCosts& costs,
                     MakeQuery&& make_query) {
  AllPairsOf pairs(typename Best::Pairs(shapes),
                   all_object_pairs(static_cast<std::uint32_t>(shapes.size())));
  double cost = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Counting counts;
    pairs.frame(samples[k], counts, make_query, [](auto&&...) {});
    if (SampledFrames::counted(k))
      cost += costs(pairs_of_moved(samples[k - 1], samples[k]), pairs.front_size(), counts.n_v,
                    counts.n_p);
  }
  return cost;
}

/// `with_recommended` for a motion that is known: `frames[k]` has the poses of all bodies in frame
/// k, body i has mesh i modulo the number of meshes. Makes up to four hierarchies of each mesh.
template <class MakeQuery, class Visit>
decltype(auto) with_recommended(std::span<const TriangleMesh> meshes,
                                std::span<const std::vector<Pose>> frames, MakeQuery&& make_query,
                                Visit&& visit) {
  using Query = std::remove_cvref_t<decltype(make_query(std::size_t{0}))>;
  std::vector<std::vector<Pose>> samples;
  const std::size_t bodies = frames.empty() ? 0 : frames[0].size(),
                    pairs = bodies * (bodies - 1) / 2;
  const SampledFrames sampled(frames.size(), pairs);
  for (const std::size_t frame : sampled.frames) samples.push_back(frames[frame]);
  if (samples.empty()) return visit(std::type_identity<Recommended>());
  RunCosts costs(triangles_of(meshes), pairs * frames.size());
  std::size_t number = 0, best = 0;
  std::any built;  // of the last candidate
  for_each_candidate([&]<class Best>(const RecommendedCandidate<Best>& candidate) {
    const std::size_t k = number++;
    if (!costs.may_pay(candidate.build)) return;
    using Hierarchies = std::shared_ptr<const HierarchiesBy<typename Best::Trees>>;
    if (!std::any_cast<Hierarchies>(&built))
      built = std::make_shared<const HierarchiesBy<typename Best::Trees>>(meshes);
    const auto shapes =
        shapes_over(meshes, (*std::any_cast<Hierarchies>(&built))->of_mesh, samples[0].size());
    const double cost =
        expected_cost<Best>(shapes, samples, candidate.costs(Query::name), make_query);
    if (costs.is_best(candidate.build, cost / static_cast<double>(sampled.size() * pairs)))
      best = k;
  });
  return with_candidate(best, visit);
}

}  // namespace bvlab
