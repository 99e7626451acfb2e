// SPDX-License-Identifier: BSD-3-Clause
/// A sphere: the cheapest volume to pose (one point) and to test (one distance); the volume of
/// li1998incremental (see also quinlan1994efficient, hubbard1993interactive).
///
/// `enclosing` gives the smallest sphere around points (gartner1999miniball), so there is no
/// tighter fit; `merge` is the smallest sphere around two spheres (quinlan1994efficient).
///
/// Posing (C_u) takes 18 multiplications and additions, a test (C_v) 9.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/geometry/enclosing_sphere.hpp"
#include "hierarchies/geometry/placement.hpp"

namespace bvlab {

template <Scalar S>
struct Sphere {
  static constexpr std::string_view name = sizeof(Element<S>) == 8 ? "sphere-double" : "sphere";
  static constexpr std::string_view description =
      "sphere; smallest around the points or around two others (Quinlan 1994)";
  using scalar = S;
  template <class Other>
  using over = Sphere<Other>;

  Vec3<S> centre;
  S radius;

  /// The smallest sphere around the points (one or more).
  static Sphere enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    Sphere sphere;
    sphere.centre = rounded<S>(enclosing_sphere(points).centre);
    const Vec3<double> centre = sphere.centre.template cast<double>();
    double squared = 0;
    for (const auto& p : points) squared = std::max(squared, (p - centre).squaredNorm());
    sphere.radius = safe_radius(std::sqrt(squared));
    return sphere;
  }

  /// Makes a radius safe that was computed in float64 with at most eight roundings: the factor
  /// covers these, and the added length covers underflow.
  static S safe_radius(double radius)
    requires(!Batched<S>)
  {
    return rounded_up<S>(radius * (1 + 16 * unit_roundoff<double>)+std::ldexp(
                                      1.0, std::numeric_limits<double>::min_exponent / 2));
  }
};

/// The smallest sphere around two spheres.
template <class S>
Sphere<S> merge(const Sphere<S>& a, const Sphere<S>& b) {
  const Vec3<double> from = a.centre.template cast<double>(), to = b.centre.template cast<double>();
  const double ra = a.radius, rb = b.radius, distance = (to - from).norm();
  if (distance + rb <= ra * (1 - 8 * unit_roundoff<double>)) return a;
  if (distance + ra <= rb * (1 - 8 * unit_roundoff<double>)) return b;
  const double along = distance > 0 ? (distance + rb - ra) / (2 * distance) : 0;
  Sphere<S> both;
  both.centre = rounded<S>(from + along * (to - from));
  const Vec3<double> centre = both.centre.template cast<double>();
  both.radius =
      Sphere<S>::safe_radius(std::max((centre - from).norm() + ra, (centre - to).norm() + rb));
  return both;
}

template <class S>
Sphere<S> posed(const Sphere<S>& sphere, const Placement<Element<S>>& placement) {
  return {placement.moved(sphere.centre), placement.grown(sphere.radius)};
}

/// Squares and sums are off by less than 16 unit roundoffs in all; `slack` prevents underflow. A
/// comparison with NaN (from an overflow) means not disjoint.
template <class S>
Mask<S> disjoint(const Sphere<S>& a, const Sphere<S>& b) {
  const S radii = a.radius + b.radius;
  return squared_norm<S>(a.centre - b.centre) > radii * radii * S(1 + 16 * unit_roundoff<S>);
}

/// A lower bound on the distance of the two spheres; 0 where they may overlap.
template <class S>
S gap(const Sphere<S>& a, const Sphere<S>& b) {
  using std::sqrt;
  constexpr Element<S> e = unit_roundoff<S>;
  // Where a square overflows, the largest number is still a lower bound. NaN, from centres that are
  // not finite, stays NaN: std::min would give the other number.
  const S largest = std::numeric_limits<Element<S>>::max();
  const S squared = squared_norm<S>(a.centre - b.centre);
  const S distance = sqrt(select(squared > largest, largest, squared));
  const S apart = distance * S(1 - 8 * e) - (a.radius + b.radius) * S(1 + 2 * e);
  return select(apart > S(0), apart, S(0));  // NaN counts as no gap
}

/// Whether the point, in the frame of the sphere, is inside. True where the sphere is not finite.
template <class S>
bool contains(const Sphere<S>& sphere, const Vec3<long double>& point) {
  const Vec3<long double> offset = point - sphere.centre.template cast<long double>();
  const auto radius = static_cast<long double>(sphere.radius);
  return !(offset.squaredNorm() > radius * radius);
}

template <class S>
S size(const Sphere<S>& sphere) {
  return sphere.radius;
}

/// An upper bound on the distance of the sphere and its centre from the origin of its frame.
template <class S>
S reach(const Sphere<S>& sphere) {
  return sphere.centre.norm() + sphere.radius;
}

}  // namespace bvlab
