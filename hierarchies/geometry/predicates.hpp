// SPDX-License-Identifier: BSD-3-Clause
/// On which side a point lies: the exact signs of determinants of float64 coordinates.
///
/// A float64 filter with a derived bound decides nearly all calls; the rest are decided in
/// integers, which hold every float64 exactly whatever its exponent, so nothing is ever refused.
/// Cost: about 5 ns where the filter decides, 30 to 100 ns where it does not, microseconds where
/// the magnitudes of the coordinates spread over hundreds of binary orders. [shewchuk1997]
#pragma once

#include <algorithm>
#include <cmath>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/wide_integer.hpp"

namespace bvlab {

namespace detail {

template <class T>
int sign_of(const T& x) {
  return (x > 0) - (x < 0);
}

/// Coordinates of at most 64 N - 3 binary digits: a difference has 64 N - 2, a product of two
/// differences 128 N - 4, a difference of two products 128 N - 3, its product with a third
/// difference 192 N - 5, and the sum of three such products fewer than 192 N - 3. All fit with a
/// sign.
template <int N>
int exact_orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                      const Vec3<double>& d, int bottom) {
  using Integer = WideInteger<N>;
  Integer u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    const Integer origin = Integer::scaled(a[i], bottom);
    u[i] = Integer::scaled(b[i], bottom) - origin;
    v[i] = Integer::scaled(c[i], bottom) - origin;
    w[i] = Integer::scaled(d[i], bottom) - origin;
  }
  return ((u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
          (u[0] * v[1] - u[1] * v[0]) * w[2])
      .sign();
}

template <int N>
int exact_orientation(const double* a, const double* b, const double* c, int i, int j, int bottom) {
  using Integer = WideInteger<N>;
  const Integer x = Integer::scaled(a[i], bottom), y = Integer::scaled(a[j], bottom);
  return ((Integer::scaled(b[i], bottom) - x) * (Integer::scaled(c[j], bottom) - y) -
          (Integer::scaled(b[j], bottom) - y) * (Integer::scaled(c[i], bottom) - x))
      .sign();
}

/// Calls `f` with the number of limbs that coordinates of so many binary digits need. Float64
/// spans 2^-1074 to 2^1024, so 33 limbs hold anything.
template <class F>
int with_limbs(int bits, const F& f) {
  if (bits <= 64 - 3) return f(std::integral_constant<int, 1>{});
  if (bits <= 2 * 64 - 3) return f(std::integral_constant<int, 2>{});
  if (bits <= 5 * 64 - 3) return f(std::integral_constant<int, 5>{});
  return f(std::integral_constant<int, 33>{});
}
static_assert(33 * 64 - 3 >= 1074 + 1024);

inline int exact_orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                             const Vec3<double>& d) {
  BinaryRange range;
  for (const auto* p : {&a, &b, &c, &d})
    for (int i = 0; i < 3; ++i) range.include((*p)[i]);
  return with_limbs(range.bits(), [&](auto limbs) {
    return exact_orientation<limbs()>(a, b, c, d, range.bottom);
  });
}

inline int exact_orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                             int i, int j) {
  BinaryRange range;
  for (const auto* p : {&a, &b, &c}) range.include((*p)[i]), range.include((*p)[j]);
  return with_limbs(range.bits(), [&](auto limbs) {
    return exact_orientation<limbs()>(a.data(), b.data(), c.data(), i, j, range.bottom);
  });
}

}  // namespace detail

/// The sign of det [b-a, c-a, d-a]: 1 where d lies on that side of the plane a, b, c from which
/// they turn counterclockwise, 0 where all four lie in one plane, else -1. Exact for finite
/// coordinates.
///
/// Filter: each difference carries one rounding (factor 1+u), each of the six triple products two
/// more and the subtraction inside its minor one, the two last sums two: in all at most 7u + O(u^2)
/// of the sum P of the magnitudes of the six products, and P as computed is at most 7u + O(u^2)
/// of itself too small, so that (7 + 56 u) u P bounds the error [shewchuk1997, orient3d's bound A].
/// Underflow adds at most 2^-1075 to each product: to a minor's products, where it is multiplied
/// by a difference below 2^340, and to the three last ones; 2^-700 bounds that, in P too.
inline int orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                       const Vec3<double>& d) {
  constexpr double u = unit_roundoff<double>;
  const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  const double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
  const double determinant = (yz - zy) * wx + (zx - xz) * wy + (xy - yx) * wz;
  const double magnitude = (std::abs(yz) + std::abs(zy)) * std::abs(wx) +
                           (std::abs(zx) + std::abs(xz)) * std::abs(wy) +
                           (std::abs(xy) + std::abs(yx)) * std::abs(wz);
  const double bound = (7 + 56 * u) * u * magnitude + 0x1p-700;
  const double reach = std::max({std::abs(wx), std::abs(wy), std::abs(wz)});
  if (std::abs(determinant) > bound && reach < 0x1p340 && magnitude < 0x1p1020)
    return determinant > 0 ? 1 : -1;
  return detail::exact_orientation(a, b, c, d);
}

/// The same in the plane of the coordinates i and j: 1 where a, b, c turn counterclockwise.
/// Filter: (3 + 16 u) u times the magnitudes [shewchuk1997, orient2d's bound A], and 2^-1000 for
/// what may underflow.
inline int orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c, int i,
                       int j) {
  constexpr double u = unit_roundoff<double>;
  const double left = (b[i] - a[i]) * (c[j] - a[j]);
  const double right = (b[j] - a[j]) * (c[i] - a[i]);
  const double determinant = left - right;
  const double magnitude = std::abs(left) + std::abs(right);
  if (std::abs(determinant) > (3 + 16 * u) * u * magnitude + 0x1p-1000 && magnitude < 0x1p1020)
    return determinant > 0 ? 1 : -1;
  return detail::exact_orientation(a, b, c, i, j);
}

}  // namespace bvlab
