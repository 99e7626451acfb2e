// SPDX-License-Identifier: BSD-3-Clause
/// Configurations for the queries touching and contacts that are recommended beside Recommended,
/// and a choice by the meshes alone.
///
/// There are four kinds of trees, with margins or (two of them) from the roots in every frame: six
/// candidates. Which one is fastest depends on the motion as much as on the meshes: where
/// surfaces run closely along each other, oriented boxes win on any mesh; where hardly an answer
/// outlasts a frame, margins cost more than they save; and no property of meshes that was tried
/// predicts either. `bvlab` and its Python module try them while a run goes on
/// (experiments/replay/trials.hpp).
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "traversal/recommended.hpp"
#include "traversal/wide/mixed_kernel.hpp"

namespace bvlab {

/// Oriented boxes, which fit best: for meshes of long triangles, as in models of plates and beams,
/// and for surfaces that run closely along each other.
using RecommendedOriented =
    MarginsOver<WideTrees<Obb<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::published, 4>>;

/// The same with boxes of a tight fit, for long runs: trees take two to three times as long to
/// build, frames up to a third less time and mostly a few hundredths.
using RecommendedTight =
    MarginsOver<WideTrees<Obb<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::tight, 4>>;

/// Slab-boxes in smaller leaves, for bodies that come near each other at few triangles.
using RecommendedSmallLeaves = MarginsOver<
    WideTrees<SlabBox<float>, 4, MixedKernel, builds::TopDownSurfaceArea, Fit::published, 4>>;

/// Slab-boxes and oriented boxes from the roots: for bodies so fast, or so often in contact,
/// that hardly an answer outlasts a frame.
using RecommendedRoots = RootsOf<Recommended::Trees>;
using RecommendedOrientedRoots = RootsOf<RecommendedOriented::Trees>;

/// A configuration that may be recommended.
template <class Best>
struct RecommendedCandidate {
  using Configuration = Best;
  std::string_view name;
  double build;  ///< of a triangle's share of the trees, in nanoseconds
};

/// What a tree that is made on demand costs before anything of it is made, in nanoseconds a
/// triangle.
inline constexpr double on_demand = 50;

/// The candidates; one from the roots follows the one with the same trees. Small leaves from the
/// roots never cost least.
inline constexpr std::tuple recommended_candidates{
    RecommendedCandidate<Recommended>{"slab-boxes", on_demand},
    RecommendedCandidate<RecommendedRoots>{"slab-boxes from the roots", on_demand},
    RecommendedCandidate<RecommendedSmallLeaves>{"slab-boxes in small leaves", 1050},
    RecommendedCandidate<RecommendedOriented>{"oriented boxes", 1150},
    RecommendedCandidate<RecommendedOrientedRoots>{"oriented boxes from the roots", 1150},
    RecommendedCandidate<RecommendedTight>{"tight oriented boxes", 2800}};

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

/// Meshes of more triangles get slab-boxes in unknown motion, whatever their shape: the trees of
/// oriented boxes take about 50 ms or more.
inline constexpr std::size_t many_triangles = 40'000;

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

}  // namespace bvlab
