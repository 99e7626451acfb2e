// SPDX-License-Identifier: BSD-3-Clause
/// A capsule: the points within a radius of a segment. The example of
/// hierarchies/adding_a_volume.md; it is compiled and keeps all laws, but is not in the list.
///
/// The segment is centre + s axis with |s| <= half, the axis of unit length but for 8e (e the unit
/// roundoff of S). One N_u is 24 multiplications and additions, one N_v about 90.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/geometry/principal_axes.hpp"

namespace bvlab {

template <Scalar S>
struct Capsule {
  static constexpr std::string_view name = "capsule";
  static constexpr std::string_view description = "points within a radius of a segment";
  using scalar = S;
  template <class Other>
  using over = Capsule<Other>;

  // Nothing but scalars S: a batch of capsules has the same members over batches.
  Vec3<S> centre, axis;
  S half, radius;

  /// Fits are made in float64 and rounded outward. Whatever centre, axis and half length come out
  /// of it, the radius that is measured from them as they are stored makes the capsule right.
  static Capsule enclosing(std::span<const Vec3<double>> points) requires(!Batched<S>) {
    const Vec3<double> along = principal_axes(points).row(0).transpose();
    double low = 0, high = 0;
    for (const auto& p : points) {
      const double x = along.dot(p - points[0]);
      low = std::min(low, x), high = std::max(high, x);
    }
    Capsule capsule;
    capsule.centre = rounded<S>(points[0] + (low + high) / 2 * along);
    capsule.axis = rounded<S>(along);
    // Not the whole length: the ends are round.
    Vec3<double> centre = points[0] + (low + high) / 2 * along;
    double across = 0;
    for (const auto& p : points) {
      const Vec3<double> x = p - centre;
      across = std::max(across, (x - along.dot(x) * along).norm());
    }
    capsule.half = rounded_up<S>(std::max(0.0, (high - low) / 2 - across / 2));
    capsule.radius = radius_for(capsule, points);
    return capsule;
  }

  /// The largest distance of a point from the segment, at most: any point of the segment gives a
  /// bound. Fewer than ten roundings, each less than u of the lengths that are summed.
  static S radius_for(const Capsule& capsule,
                      std::span<const Vec3<double>> points) requires(!Batched<S>) {
    constexpr double u = unit_roundoff<double>;
    const Vec3<double> centre = capsule.centre.template cast<double>(),
                       axis = capsule.axis.template cast<double>();
    const double half = capsule.half;
    double radius = 0, farthest = 0;
    for (const auto& p : points) {
      const Vec3<double> x = p - centre;
      farthest = std::max(farthest, x.lpNorm<1>());
      radius = std::max(radius, (x - std::clamp(axis.dot(x), -half, half) * axis).norm());
    }
    const double tiny = std::ldexp(1.0, std::numeric_limits<double>::min_exponent / 2);
    return rounded_up<S>(radius + 16 * u * (farthest + radius + half) + tiny);
  }
};

/// Around the four ends, by the larger radius more.
template <class S>
Capsule<S> merge(const Capsule<S>& a, const Capsule<S>& b) {
  constexpr double u = unit_roundoff<double>;
  std::array<Vec3<double>, 4> ends;
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Capsule<S>& capsule = i < 2 ? a : b;
    const double side = i % 2 ? double(capsule.half) : -double(capsule.half);
    ends[i] = capsule.centre.template cast<double>() + side * capsule.axis.template cast<double>();
    largest = std::max(largest, capsule.centre.template cast<double>().template lpNorm<1>() +
                                    double(capsule.half));
  }
  Capsule<S> both = Capsule<S>::enclosing(ends);
  const double larger_radius = std::max(a.radius, b.radius);
  both.radius = rounded_up<S>((both.radius + larger_radius) * (1 + 4 * u) + 16 * u * largest);
  return both;
}

/// One N_u. A point centre + s axis + y arrives within slack + tilt |s| + stretch |y| of the posed
/// segment (see Placement); four roundings are made here.
template <class S>
Capsule<S> posed(const Capsule<S>& capsule, const Placement<Element<S>>& placement) {
  Capsule<S> result;
  result.centre = placement.moved(capsule.centre);
  result.axis = placement.directed(capsule.axis);
  result.half = capsule.half;
  result.radius = (placement.grown(capsule.radius) + S(placement.tilt) * capsule.half) *
                  S(1 + 8 * unit_roundoff<S>);
  return result;
}

/// At most the distance between the two; 0 where they may meet.
///
/// For ANY vector n they are apart by at least
///   (n.t - half_a |n.axis_a| - half_b |n.axis_b|) / |n| - radius_a - radius_b,
/// t between the centres, so that only the rounding of this line matters, not where n comes from:
/// less than 16e |n| (|t_0| + |t_1| + |t_2| + half_a + half_b), as for Rss. And n comes from
/// points of the segments that are nearly nearest, each found from the other in turn.
template <class S>
[[gnu::always_inline]] inline S gap(const Capsule<S>& a, const Capsule<S>& b) {
  using std::abs, std::max, std::min, std::sqrt;
  constexpr Element<S> e = unit_roundoff<S>;
  const Vec3<S> t = b.centre - a.centre;
  Vec3<S> on_a, on_b = t;
  for (int round = 0; round < 3; ++round) {
    on_a = a.axis * min(max(dot<S>(on_b, a.axis), -a.half), a.half);
    on_b = t + b.axis * min(max(dot<S>(Vec3<S>(on_a - t), b.axis), -b.half), b.half);
  }
  const Vec3<S> n = on_b - on_a;
  const S squared = squared_norm<S>(n);
  const S extent = a.half * abs(dot<S>(n, a.axis)) + b.half * abs(dot<S>(n, b.axis));
  const S scale = ((abs(t[0]) + abs(t[1])) + abs(t[2])) + (a.half + b.half);
  const S apart = ((dot<S>(n, t) - extent) / sqrt(squared)) * S(1 - 8 * e) -
                  ((a.radius + b.radius) * S(1 + 4 * e) + scale * S(16 * e));
  // Where squares under- or overflow nothing is known; a NaN counts as nothing.
  const S largest(std::numeric_limits<Element<S>>::max() / 16),
      smallest(std::numeric_limits<Element<S>>::min() * 64);
  const Mask<S> known = apart > S(0) && squared > smallest && scale * scale < largest;
  return select(known, apart, S(0));
}

/// One N_v.
template <class S>
[[gnu::always_inline]] inline Mask<S> disjoint(const Capsule<S>& a, const Capsule<S>& b) {
  return gap(a, b) > S(0);
}

/// For the tests: slow and careful. True where it is not finite.
template <class S>
bool contains(const Capsule<S>& capsule, const Vec3<long double>& point) {
  const Vec3<long double> x = point - capsule.centre.template cast<long double>(),
                          axis = capsule.axis.template cast<long double>();
  const long double half = capsule.half, radius = capsule.radius;
  const long double at = std::clamp(axis.dot(x) / axis.squaredNorm(), -half, half);
  return !((x - at * axis).squaredNorm() > radius * radius);
}

template <class S>
S size(const Capsule<S>& capsule) {
  return capsule.half + capsule.radius;
}

template <class S>
S reach(const Capsule<S>& capsule) {
  return capsule.centre.norm() + size(capsule) * S(1 + 16 * unit_roundoff<S>);
}

}  // namespace bvlab
