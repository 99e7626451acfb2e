// SPDX-License-Identifier: BSD-3-Clause
/// The recommended configuration for given meshes, chosen while the program runs, for the queries
/// touching and contacts.
///
/// The choice is by the shape of triangles alone. Where surfaces run along each other closely for
/// many frames, oriented boxes win on other meshes, too; that depends on the motion, and no
/// property of the meshes shows it.
#pragma once

#include <span>
#include <type_traits>
#include <utility>

#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "traversal/recommended.hpp"
#include "traversal/wide/mixed_kernel.hpp"

namespace bvlab {

/// For meshes of long triangles, as models of plates and beams have them: oriented boxes.
using RecommendedForLongTriangles =
    MarginsOver<Obb<float>, 4, MixedKernel, builds::BottomUpLocal, Fit::tight, 4>;

/// Calls `visit` with std::type_identity of Recommended or RecommendedForLongTriangles, and returns
/// what it returns. O(triangles). For example, of bodies that all have one mesh:
///
///     with_recommended(std::span(&mesh, 1), [&]<class Best>(std::type_identity<Best>) {
///       const auto tree = Best::hierarchy(mesh);
///       const std::vector<typename Best::Shape> shapes(bodies, {&mesh, &tree});
///       World<typename Best::Pairs> world{typename Best::Pairs(shapes)};
///     });
template <class Visit>
decltype(auto) with_recommended(std::span<const TriangleMesh> meshes, Visit&& visit) {
  if (elongation(meshes) < long_triangles) return visit(std::type_identity<Recommended>());
  return visit(std::type_identity<RecommendedForLongTriangles>());
}

}  // namespace bvlab
