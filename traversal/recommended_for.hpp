// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for given meshes, or for given meshes and their motion, for the
/// queries touching and contacts.
///
/// Three configurations are candidates. Which of them is fastest depends on the motion as much as
/// on the meshes: where surfaces run along each other closely, oriented boxes win on any mesh, and
/// no property of the meshes that was tried shows that. So where the motion is known, short samples
/// of it are played by all candidates, and the expected cost
///
///     N_v C_v + N_p C_p
///
/// of a pair, with the N counted on the samples and the C below, decides. Counts do not depend on
/// the machine's load, so the choice is repeatable. Where the motion is not known, the shape of the
/// triangles decides.
#pragma once

#include <algorithm>
#include <array>
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
#include "traversal/recommended.hpp"
#include "traversal/wide/mixed_kernel.hpp"

namespace bvlab {

/// Oriented boxes, which fit best and cost most: for meshes of long triangles, as models of plates
/// and beams have them, for surfaces that run along each other, and for contacts.
using RecommendedOriented =
    MarginsOver<Obb<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::tight, 4>;

/// Slab-boxes in smaller leaves, for bodies that come near each other at few triangles.
using RecommendedSmallLeaves = MarginsOver<SlabBox<float>, recommended_fan_out, SiblingsKernel,
                                           builds::BottomUpLocal, Fit::published, 4>;

/// What a test of two volumes (C_v) and of two triangles (C_p) costs, in nanoseconds on the machine
/// of record real-motions; posing is part of C_v. Only their ratios matter.
struct UnitCosts {
  double volume, triangle;
};

/// THE list of candidates, each with its unit costs. These were fitted by least squares of relative
/// error to the times of 18 motions (touching) and 11 (contacts): eight planning problems, and
/// bunnies of 500 and 8000 polygons in five kinds of motion.
struct Candidates {
  template <class Best>
  struct Of {
    using type = Best;
    std::string_view name;
    UnitCosts touching, contacts;
  };
  template <class Do>
  static void for_each(Do&& what) {
    what(Of<Recommended>{"slab-boxes", {5.5, 1.7}, {5.2, 1.2}});
    what(Of<RecommendedSmallLeaves>{"slab-boxes in small leaves", {6.8, 7.2}, {8.3, 3.1}});
    what(Of<RecommendedOriented>{"oriented boxes", {6.3, 10.0}, {5.8, 3.4}});
  }
};

/// The frames of a motion that are played for the choice: up to sixteen runs of four consecutive
/// frames, evenly spread over at most a quarter of the motion. None of a motion of fewer than 16.
inline std::vector<std::size_t> sampled_frames(std::size_t frames) {
  constexpr std::size_t together = 4, most = 16;
  const std::size_t runs = std::min(most, frames / (4 * together));
  std::vector<std::size_t> sampled;
  for (std::size_t run = 0; run < runs; ++run)
    for (std::size_t k = 0; k < together; ++k)
      sampled.push_back((2 * run + 1) * frames / (2 * runs) - together / 2 + k);
  return sampled;
}
/// Meshes of more triangles in all are not built three times for a choice.
inline constexpr std::size_t most_triangles_to_sample = 200'000;

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

/// What `frames` cost a pair by one candidate, in the unit of its unit costs. `frames[k]` has the
/// poses of all bodies; body i has mesh i mod their number. `make_query(p)` as in WidePairs::frame.
template <class Best, class MakeQuery>
double expected_cost(std::span<const TriangleMesh> meshes,
                     std::span<const std::vector<Pose>> frames, const UnitCosts& costs,
                     MakeQuery&& make_query) {
  if (frames.empty()) return 0;
  std::vector<typename Best::Hierarchy> hierarchies;
  for (const auto& mesh : meshes) hierarchies.push_back(Best::hierarchy(mesh));
  std::vector<typename Best::Shape> shapes;
  for (std::size_t i = 0; i < frames[0].size(); ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  typename Best::Pairs pairs(shapes, all_object_pairs(static_cast<std::uint32_t>(shapes.size())));
  Counting counter;
  for (const auto& poses : frames) pairs.frame(poses, counter, make_query, [](auto&&...) {});
  return static_cast<double>(counter.n_v) * costs.volume +
         static_cast<double>(counter.n_p) * costs.triangle;
}

/// The same for a motion that is known: `frames[k]` has the poses of all bodies in frame k.
/// `make_query(p)` returns the query of pair p, as in WidePairs::frame.
template <class MakeQuery, class Visit>
decltype(auto) with_recommended(std::span<const TriangleMesh> meshes,
                                std::span<const std::vector<Pose>> frames, MakeQuery&& make_query,
                                Visit&& visit) {
  using Query = std::remove_cvref_t<decltype(make_query(std::size_t{0}))>;
  std::vector<std::vector<Pose>> samples;
  for (const std::size_t frame : sampled_frames(frames.size())) samples.push_back(frames[frame]);
  std::size_t triangles = 0;
  for (const auto& mesh : meshes) triangles += mesh.triangles.size();
  if (samples.empty() || triangles > most_triangles_to_sample)
    return with_recommended(meshes, visit);
  std::array<double, 3> cost;
  std::size_t k = 0;
  Candidates::for_each([&]<class Best>(const Candidates::Of<Best>& candidate) {
    cost[k++] = expected_cost<Best>(
        meshes, samples, Query::one_hit_is_enough ? candidate.touching : candidate.contacts,
        make_query);
  });
  if (cost[0] <= cost[1] && cost[0] <= cost[2]) return visit(std::type_identity<Recommended>());
  if (cost[1] <= cost[2]) return visit(std::type_identity<RecommendedSmallLeaves>());
  return visit(std::type_identity<RecommendedOriented>());
}

}  // namespace bvlab
