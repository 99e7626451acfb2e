// SPDX-License-Identifier: BSD-3-Clause
/// The transform of corners from one body's frame to the other's, in float (CornerTransform), and a
/// node's sphere in both frames (ReferenceSphere), on which relative motion is bounded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/node_sphere.hpp"
#include "hierarchies/wide/lanes.hpp"
#include "traversal/transpose.hpp"

namespace bvlab {

/// Transforms corners of a into the frame of b's mesh, in float, for the float filter of triangles.
/// The fourth number of `Four` is unused.
class CornerTransform {
 public:
  using Four = Batch<float, 4>;

  /// Prepares the transform and its error bound. Corners, rotation and translation are each rounded
  /// to float; three products and three sums follow. Where lengths reach 2^100 these may overflow:
  /// then the error bound is infinite.
  void begin(const RelativePose& a_from_b, double reach_a, double reach_b) {
    constexpr double e = unit_roundoff<float>;
    error_bound_ = reach_a + a_from_b.length + reach_b < 0x1p100
                       ? static_cast<float>((16 * e * (reach_a + a_from_b.length) +
                                             2 * e * reach_b + a_from_b.error_bound) *
                                            (1 + 8 * e)) +
                             std::numeric_limits<float>::min()
                       : std::numeric_limits<float>::infinity();
    for (int i = 0; i < 3; ++i)
      rounded_to_float(a_from_b.column[static_cast<std::size_t>(i)])
          .copy_to(column_[i], stdx::vector_aligned);
    rounded_to_float(a_from_b.translation).copy_to(translation_, stdx::vector_aligned);
  }

  [[gnu::always_inline]] Four operator()(float x, float y, float z) const {
    const auto from = [](const float* p) { return Four(p, stdx::vector_aligned); };
    return fused<Four>(from(column_[2]), Four(z),
                       fused<Four>(from(column_[1]), Four(y),
                                   fused<Four>(from(column_[0]), Four(x), from(translation_))));
  }

  /// The same for several points, one per lane.
  template <Batched S>
  [[gnu::always_inline]] std::array<S, 3> operator()(const S& x, const S& y, const S& z) const {
    std::array<S, 3> result;
    for (std::size_t i = 0; i < 3; ++i)
      result[i] = fused<S>(
          S(column_[2][i]), z,
          fused<S>(S(column_[1][i]), y, fused<S>(S(column_[0][i]), x, S(translation_[i]))));
    return result;
  }

  /// The error bound of each coordinate of a transformed corner, in units of the meshes.
  float error_bound() const { return error_bound_; }

 private:
  alignas(16) float column_[3][4], translation_[4];
  float error_bound_;
};

/// A sphere around the triangles of a node of a or b, with its centre in the frames of both meshes.
/// Relative motion of the bodies is bounded on it (see measured_gaps.hpp).
struct ReferenceSphere {
  /// In the frame of a, and of b; the fourth number is unused.
  alignas(16) std::array<std::array<float, 4>, 2> centre_in;
  float radius;
  float error_bound;  ///< of each coordinate
};

/// The reference sphere of a node of the body `side`, 0 for a; transforms[0] takes points of a to
/// b, transforms[1] back.
[[gnu::always_inline]] inline ReferenceSphere reference_sphere_of(
    const NodeSphere& sphere, std::size_t side, const std::array<CornerTransform, 2>& transforms) {
  ReferenceSphere reference;
  std::copy_n(sphere.centre, 3, reference.centre_in[side].begin());
  transforms[side](sphere.centre[0], sphere.centre[1], sphere.centre[2])
      .copy_to(reference.centre_in[1 - side].data(), stdx::vector_aligned);
  reference.radius = sphere.radius, reference.error_bound = transforms[side].error_bound();
  return reference;
}
/// The same for the smaller of two nodes' spheres, without a branch, which would be unpredictable.
[[gnu::always_inline]] inline ReferenceSphere reference_sphere_of_smaller(
    const NodeSphere& a, const NodeSphere& b, const std::array<CornerTransform, 2>& transforms) {
  const std::array<const NodeSphere*, 2> spheres{&a, &b};
  const auto side = static_cast<std::size_t>(!(a.radius < b.radius));
  return reference_sphere_of(*spheres[side], side, transforms);
}

/// The reference sphere of a triangle of a about its first corner; `corner(i, k)` is coordinate k
/// of its corner i.
template <class Corner>
ReferenceSphere reference_sphere_of_triangle(const Corner& corner, const CornerTransform& a_to_b) {
  ReferenceSphere reference;
  auto& centre = reference.centre_in[0];
  for (std::size_t k = 0; k < 3; ++k) centre[k] = corner(0, k);
  a_to_b(centre[0], centre[1], centre[2])
      .copy_to(reference.centre_in[1].data(), stdx::vector_aligned);
  float squared = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    float length = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float side = corner(i, k) - centre[k];
      length += side * side;
    }
    squared = std::max(squared, length);
  }
  reference.radius = std::sqrt(squared) * (1 + 16 * unit_roundoff<float>);
  reference.error_bound = a_to_b.error_bound();
  return reference;
}

/// Reference spheres, one per lane.
template <Batched S>
struct ReferenceSpheres {
  std::array<std::array<S, 3>, 2> centre_in;
  S radius, error_bound;
};
/// The reference sphere of the smaller of two nodes, one pair of nodes per lane: sphere(side, k)
/// points to the sphere of a node.
template <Batched S, class SphereOf>
[[gnu::always_inline]] inline ReferenceSpheres<S> reference_spheres_of_smaller(
    const SphereOf& sphere, const std::array<CornerTransform, 2>& transforms) {
  constexpr int W = width<S>();
  const auto of_side = [&](std::size_t side) __attribute__((always_inline)) {
    const auto centre_and_radius = [&](int k) __attribute__((always_inline)) {
      return sphere(side, k)->centre;  // the radius follows
    };
    return detail::columns_of<float, W>(centre_and_radius);
  };
  const auto a = of_side(0), b = of_side(1);
  const auto batch = [](const auto& lanes) __attribute__((always_inline)) {
    return detail::batch_from<S>(lanes);
  };
  const S radius_a = batch(a[3]), radius_b = batch(b[3]);
  const auto of_a = radius_a < radius_b;
  std::array<S, 3> centre;
  for (std::size_t i = 0; i < 3; ++i) centre[i] = select(of_a, batch(a[i]), batch(b[i]));
  const auto in_b = transforms[0](centre[0], centre[1], centre[2]),
             in_a = transforms[1](centre[0], centre[1], centre[2]);
  ReferenceSpheres<S> spheres;
  for (std::size_t i = 0; i < 3; ++i) {
    spheres.centre_in[0][i] = select(of_a, centre[i], in_a[i]);
    spheres.centre_in[1][i] = select(of_a, in_b[i], centre[i]);
  }
  spheres.radius = select(of_a, radius_a, radius_b);
  spheres.error_bound =
      select(of_a, S(transforms[0].error_bound()), S(transforms[1].error_bound()));
  return spheres;
}

}  // namespace bvlab
