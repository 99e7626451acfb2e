// SPDX-License-Identifier: BSD-3-Clause
/// A spherical shell: all points between an inner and an outer radius from the centre, within an
/// angle of the axis (krishnan1998spherical). It stays thin on curved surfaces, unlike any box.
///
/// The shell is the set of points centre + y with inner <= |y| <= outer and y.axis >= cosine |y|
/// |axis|; all directions where the cosine is not positive. The axis is of unit length up to 16e.
/// Posing (C_u) takes about 40 operations, a test (C_v) about 250.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/geometry/enclosing_sphere.hpp"
#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/geometry/shell_centres.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

template <Scalar S>
struct Shell {
  static constexpr std::string_view name = "shell";
  static constexpr std::string_view description =
      "spherical shell, a piece of a hollow sphere, fitted to triangles (Krishnan 1998)";
  using scalar = S;
  template <class Other>
  using over = Shell<Other>;

  Vec3<S> centre;
  Vec3<S> axis;
  S inner, outer;
  S cosine;  ///< of the half angle; -2 (all directions) unless that is less than a right angle

  static constexpr Element<S> all_around = -2;

  /// The shell around points only.
  static Shell enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    return thinnest(points, [&](const Vec3<double>& centre) {
      double inner = std::numeric_limits<double>::infinity();
      for (const auto& p : points) inner = std::min(inner, (p - centre).norm());
      return inner;
    });
  }

  /// The shell around a surface, which may come nearer to the centre than its vertices.
  static Shell enclosing(std::span<const Vec3<double>> points, std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    return thinnest(points, to_nearest(triangles));
  }

  /// The shell around a surface with the least surface area found: starts from the published shell
  /// and others about the same centres, each with the narrowest cone, and improves the centre of
  /// the best one. Five to seven times as expensive.
  static Shell tight(std::span<const Vec3<double>> points, std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    const auto inner = to_nearest(triangles);
    Shell best = enclosing(points, triangles);
    double least = surface(best);
    Vec3<double> at = best.centre.template cast<double>();
    const auto better = [&](const Vec3<double>& near) {
      const Vec3<S> centre = rounded<S>(near);
      const Vec3<double> axis = narrowest_axis(centre.template cast<double>(), points);
      const Shell shell = about(centre, axis, points, inner);
      const double other = surface(shell);
      if (!(other < least)) return false;
      best = shell, least = other;
      return true;
    };
    const EnclosingSphere sphere = enclosing_sphere(points);
    auto centres = shell_centres(sphere, points);
    centres.push_back(at);
    for (const auto& centre : centres)
      if (better(centre)) at = centre;
    improve_centre(at, sphere, better);
    return best;
  }

 private:
  static auto to_nearest(std::span<const Triangle> triangles) {
    return [triangles](const Vec3<double>& centre) {
      double inner = std::numeric_limits<double>::infinity();
      for (const auto& t : triangles) inner = std::min(inner, detail::distance_below(centre, t));
      return inner;
    };
  }

  /// The shell of least volume among a hollow sphere about the enclosing sphere's centre and shells
  /// about `shell_centres` with their axes towards it.
  template <class Inner>
  static Shell thinnest(std::span<const Vec3<double>> points, const Inner& inner) {
    const EnclosingSphere sphere = enclosing_sphere(points);
    const auto towards_centre = [&](const Vec3<double>& near) {
      const Vec3<S> centre = rounded<S>(near);
      return about(centre, sphere.centre - centre.template cast<double>(), points, inner);
    };
    Shell best = towards_centre(sphere.centre);
    for (const auto& centre : shell_centres(sphere, points)) {
      const Shell shell = towards_centre(centre);
      if (volume(shell) < volume(best)) best = shell;
    }
    return best;
  }

  /// The smallest shell about a centre with an axis of any length. Lengths are computed in float64
  /// with fewer than 8 roundings, cosines with fewer than 16, for the axis as rounded.
  template <class Inner>
  static Shell about(const Vec3<S>& rounded_centre, const Vec3<double>& along,
                     std::span<const Vec3<double>> points, const Inner& inner) {
    constexpr double u = unit_roundoff<double>;
    const double tiny = std::ldexp(1.0, std::numeric_limits<double>::min_exponent / 2);
    Shell shell;
    shell.centre = rounded_centre;
    const Vec3<double> centre = shell.centre.template cast<double>();
    const Vec3<double> towards = along.stableNormalized();
    shell.axis = rounded<S>(towards.norm() > 0.5 ? towards : Vec3<double>::UnitX());
    const Vec3<double> axis = shell.axis.template cast<double>();
    double farthest = 0, cosine = 1;
    for (const auto& p : points) {
      const Vec3<double> y = p - centre;
      const double length = y.norm();
      farthest = std::max(farthest, length);
      cosine = std::min(cosine, length > 0 ? y.dot(axis) / (length * axis.norm()) : -1);
    }
    cosine -= 32 * u;
    shell.outer = rounded_up<S>(farthest * (1 + 16 * u) + tiny);
    shell.inner = rounded_down<S>(std::max(0.0, inner(centre) * (1 - 16 * u) - tiny));
    // A cone wider than a half space is not convex, and one nearly as wide may pose to such.
    shell.cosine = cosine > 0.01 ? rounded_down<S>(cosine) : all_around;
    return shell;
  }

  /// The volume, divided by 2 pi / 3.
  static double volume(const Shell& shell) {
    const double outer = shell.outer, inner = shell.inner;
    // A thickness below the tests' margin brings no benefit.
    const double thickness = outer - inner + 64 * unit_roundoff<S> * outer;
    const double cap = shell.cosine > 0 ? 1 - double(shell.cosine) : 2;
    return cap * thickness * (outer * outer + outer * inner + inner * inner);
  }

  /// The area of both caps and the cone between them, divided by 2 pi.
  static double surface(const Shell& shell) {
    const double outer = shell.outer, inner = shell.inner, cosine = shell.cosine;
    const double caps = outer * outer + inner * inner;
    if (!(cosine > 0)) return 2 * caps;
    // The thickness in tests, which includes their margin.
    const double thickness = outer - inner + 64 * unit_roundoff<S> * outer;
    const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
    return (1 - cosine) * caps + sine * (outer + inner) / 2 * thickness;
  }
};

/// A full sphere around both. It need not be tight, as a parent mostly takes the fitted volume.
template <class S>
Shell<S> merge(const Shell<S>& a, const Shell<S>& b) {
  const Vec3<double> from = a.centre.template cast<double>(), to = b.centre.template cast<double>();
  const double ra = a.outer, rb = b.outer, distance = (to - from).norm();
  const double along =
      distance > 0 ? std::clamp((distance + rb - ra) / (2 * distance), 0.0, 1.0) : 0;
  Shell<S> both;
  both.centre = rounded<S>(from + along * (to - from));
  both.axis = Vec3<S>::UnitX();
  const Vec3<double> centre = both.centre.template cast<double>();
  const double radius = std::max((centre - from).norm() + ra, (centre - to).norm() + rb);
  both.outer = rounded_up<S>(radius * (1 + 16 * unit_roundoff<double>)+std::ldexp(
                                          1.0, std::numeric_limits<double>::min_exponent / 2));
  both.inner = 0, both.cosine = Shell<S>::all_around;
  return both;
}

/// With s the stretch and D = |R'R - I| < s^2 - 1, a point centre + y goes to the posed centre
/// plus y' = Ry + g, |g| <= slack (see Placement), so that
///   |y'| <= s |y| + slack, |y'| >= sqrt(1 - D) |y| - slack >= (3 - 2s) |y| - slack,
/// since (1 - D)(1 + D)^2 >= 1 makes sqrt(1 - D) >= 1 / s^2. For the axis as it is posed,
///   y'.axis' >= y.axis - D |y| |axis| - tilt s |y| |axis| - slack |axis'|
///            >= (cosine - 4.3 (s - 1) - 2.2 tilt - 2.3 slack / |y'|) |y'| |axis'|
/// for s < 1.01 (else slack is infinite), since |axis'| <= (s + tilt) |axis|; and |y'| is at least
/// the new inner radius.
template <class S>
Shell<S> posed(const Shell<S>& shell, const Placement<Element<S>>& placement) {
  using std::max;
  constexpr Element<S> e = unit_roundoff<S>;
  const S slack(placement.slack), excess(placement.stretch - 1);
  Shell<S> result;
  result.centre = placement.moved(shell.centre);
  result.axis = placement.directed(shell.axis);
  result.outer = placement.grown(shell.outer) * S(1 + 4 * e);
  const S inner = shell.inner * (S(1 - 4 * e) - S(2) * excess) - slack * S(1 + 4 * e);
  result.inner = select(inner > S(0), inner, S(0));
  const S cosine = shell.cosine - (S(5) * excess + S(3) * S(placement.tilt) + S(8 * e) +
                                   S(3) * slack / result.inner);
  // Where the inner radius is 0 this is NaN or minus infinity.
  result.cosine = select(cosine > S(0), cosine, S(Shell<S>::all_around));
  return result;
}

namespace detail {

/// A shell seen along a direction that is given by the cosine and sine of its angle with the axis:
/// the cosines of the angles between that direction and the nearest and the farthest direction in
/// the shell's cone. Below, f is the angle to the axis and t the cone's half angle.
///
/// Given values off by 24e (16e for the axis' length, 8e for the rest) the sums are off by 28e.
/// Where f passes t on the wrong side of the comparison, the cosines differ by 24e at most, and so
/// cos(f - t) from 1 by 24e. In all that is less than 64e.
template <class S>
struct ShellAngles {
  S nearest, farthest;

  ShellAngles(const Shell<S>& shell, const S& sine_of_shell, const S& cosine, const S& sine) {
    using std::max, std::min;
    const S both = cosine * shell.cosine, rest = sine * sine_of_shell;
    const Mask<S> all = shell.cosine < S(0);
    nearest = select(all || cosine >= shell.cosine, S(1), min(S(1), both + rest));
    farthest = select(all || cosine <= -shell.cosine, S(-1), max(S(-1), both - rest));
  }
};

}  // namespace detail

/// A lower bound on the distance of two shells; 0 where they may overlap. The largest of these
/// bounds, each of which holds by itself:
/// - the distances of one shell's points from the other's centre form an interval; where it misses
///   the interval between the other's radii, the shells are as far apart as the intervals: from a
///   point p at distance d from the centre, at angle f from the axis, a shell of half angle t is
///   no nearer than |r, c| = sqrt(r^2 + d^2 + 2 r d c) with c = cos min(pi, f + t) and
///   r = -d c clamped to the radii, and no farther than the larger |r, c| of both radii with
///   c = cos max(0, f - t), f being measured from p through the centre;
/// - along a unit vector n a shell ends at n.centre + c (outer or, where c < 0, inner), with
///   c = cos max(0, f - t): for n the two axes and the line between the centres of their axes.
///
/// Margins: let L = outer_a + outer_b + |t_0| + |t_1| + |t_2|, t between the centres. Cosines are
/// off by 64e (see ShellAngles), so support values by 64e (outer_a + outer_b) and n.t by 8e |t|;
/// squares of distances by 2 r d 64e <= 32e L^2 and by a dozen roundings of terms below L^2. Both
/// are covered by 96e.
template <class S>
S gap(const Shell<S>& a, const Shell<S>& b) {
  using std::abs, std::max, std::min, std::sqrt;
  using T = Element<S>;
  constexpr T e = unit_roundoff<S>;
  const Vec3<S> t = b.centre - a.centre;
  const S scale = ((abs(t[0]) + abs(t[1])) + abs(t[2])) + (a.outer + b.outer);
  const S margin = scale * S(96 * e), square_margin = scale * margin;
  // Squares below this may be inexact by underflow.
  const S smallest(64 * std::numeric_limits<T>::min());
  constexpr T infinity = std::numeric_limits<T>::infinity();
  const S squared_distance = squared_norm<S>(t), distance = sqrt(squared_distance);
  const S sine_a = sqrt(max(S(0), (S(1) - a.cosine) * (S(1) + a.cosine))),
          sine_b = sqrt(max(S(0), (S(1) - b.cosine) * (S(1) + b.cosine)));

  const auto cosine_and_sine =
      [](const Vec3<S>& axis, const Vec3<S>& n, const S& length) __attribute__((always_inline)) {
    const Vec3<S> cross(axis[1] * n[2] - axis[2] * n[1], axis[2] * n[0] - axis[0] * n[2],
                        axis[0] * n[1] - axis[1] * n[0]);
    return std::array<S, 2>{dot<S>(axis, n) / length, sqrt(squared_norm<S>(cross)) / length};
  };
  S apart(0);
  const auto consider = [&](const S& x) { apart = select(x > apart, x, apart); };

  // Bounds from the distances of `shell` to the other's centre; `cosine` is that of the angle
  // between the shell's axis and the direction from that centre to the shell's.
  const auto from_centre = [&](const Shell<S>& shell, const S& own_sine, const S& cosine,
                               const S& sine, const Shell<S>& other) {
    const detail::ShellAngles<S> angles(shell, own_sine, cosine, sine);
    const auto square = [&](const S& r, const S& c) {
      return (r * r + distance * distance) + S(2) * r * distance * c;
    };
    const S r = min(max(-distance * angles.farthest, shell.inner), shell.outer);
    const S least = square(r, angles.farthest) - square_margin;
    consider(sqrt(max(S(0), least)) * S(1 - 4 * e) - other.outer);
    const S most = max(square(shell.inner, angles.nearest), square(shell.outer, angles.nearest));
    consider(other.inner - sqrt(max(S(0), most) + square_margin) * S(1 + 4 * e));
  };
  const auto to_a = cosine_and_sine(a.axis, t, -distance);
  const auto to_b = cosine_and_sine(b.axis, t, distance);
  from_centre(a, sine_a, to_a[0], abs(to_a[1]), b);
  from_centre(b, sine_b, to_b[0], abs(to_b[1]), a);

  // Along n, towards b where `sign` is 1.
  const auto along = [&](const Vec3<S>& n) {
    const S squared = squared_norm<S>(n), length = sqrt(squared);
    const auto in_a = cosine_and_sine(a.axis, n, length), in_b = cosine_and_sine(b.axis, n, length);
    const S between = dot<S>(t, n) / length;
    const auto extent = [](const Shell<S>& shell, const S& own_sine, const S& cosine,
                           const S& sine) {
      const S c = detail::ShellAngles<S>(shell, own_sine, cosine, sine).nearest;
      return c * select(c >= S(0), shell.outer, shell.inner);
    };
    const S safe = select(squared > smallest, margin, S(infinity));
    consider((between - safe) -
             (extent(a, sine_a, in_a[0], in_a[1]) + extent(b, sine_b, -in_b[0], in_b[1])));
    consider((-between - safe) -
             (extent(a, sine_a, -in_a[0], in_a[1]) + extent(b, sine_b, in_b[0], in_b[1])));
  };
  along(a.axis);
  along(b.axis);
  const auto centre_of_axis = [](const Shell<S>& shell) -> Vec3<S> {
    return shell.axis * select(shell.cosine > S(0), (shell.inner + shell.outer) / S(2), S(0));
  };
  along(Vec3<S>(t + (centre_of_axis(b) - centre_of_axis(a))));
  // Where squares under- or overflow the gap is unknown, so 0.
  const Mask<S> known =
      scale * scale < S(std::numeric_limits<T>::max() / 16) && squared_distance > smallest;
  return select(known, apart * S(1 - 4 * e), S(0));
}

template <class S>
Mask<S> disjoint(const Shell<S>& a, const Shell<S>& b) {
  return gap(a, b) > S(0);
}

/// Whether the point is inside; true where the shell is not finite.
template <class S>
bool contains(const Shell<S>& shell, const Vec3<long double>& point) {
  const Vec3<long double> y = point - shell.centre.template cast<long double>();
  const long double length = y.norm();
  if (length > static_cast<long double>(shell.outer)) return false;
  if (length < static_cast<long double>(shell.inner)) return false;
  const Vec3<long double> axis = shell.axis.template cast<long double>();
  return !(shell.cosine > 0 &&
           y.dot(axis) < static_cast<long double>(shell.cosine) * length * axis.norm());
}

/// Half of the diameter.
template <class S>
S size(const Shell<S>& shell) {
  using std::max, std::sqrt;
  const S c = max(S(0), shell.cosine), sine = sqrt(max(S(0), (S(1) - c) * (S(1) + c)));
  return select(shell.cosine > S(0),
                max(shell.outer * sine, (shell.outer - shell.inner * c) / S(2)), shell.outer);
}

/// An upper bound on the distance of the shell and its centre from the origin of its frame.
template <class S>
S reach(const Shell<S>& shell) {
  return shell.centre.norm() + shell.outer;
}

}  // namespace bvlab
