// SPDX-License-Identifier: BSD-3-Clause
/// Exact orientation predicates: the signs of determinants of float64 coordinates.
///
/// A float64 filter with a proved error bound decides nearly all calls; the rest are decided in
/// integers, which represent every float64 exactly, so every finite input has an answer. Cost:
/// about 5 ns where the filter decides, 30 to 100 ns where it does not, microseconds where the
/// magnitudes of the coordinates span hundreds of binary orders (shewchuk1997adaptive).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/wide_integer.hpp"

namespace bvlab {

namespace detail {

/// Coordinates of at most 64 N - 3 binary digits: a difference has 64 N - 2, a product of two
/// differences 128 N - 4, a difference of two products 128 N - 3, its product with a third
/// difference 192 N - 5, and the sum of three such products fewer than 192 N - 3. All fit with a
/// sign.
template <int N>
int wide_orientation(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
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
int wide_orientation(const double* a, const double* b, const double* c, int i, int j, int bottom) {
  using Integer = WideInteger<N>;
  const Integer x = Integer::scaled(a[i], bottom), y = Integer::scaled(a[j], bottom);
  return ((Integer::scaled(b[i], bottom) - x) * (Integer::scaled(c[j], bottom) - y) -
          (Integer::scaled(b[j], bottom) - y) * (Integer::scaled(c[i], bottom) - x))
      .sign();
}

/// Float64 coordinates as 60-bit integers of one common unit; `exact`: whether they can be
/// represented so. Costs a scaling, a conversion and a comparison each, and holds for most calls
/// that the filter leaves.
template <int N>
struct FixedPoint {
  std::int64_t at[N];
  bool exact;

  explicit FixedPoint(const double (&x)[N]) {
    // The bits of magnitudes are ordered as the magnitudes are.
    std::uint64_t largest = 0;
    for (int i = 0; i < N; ++i)
      largest = std::max(largest, std::bit_cast<std::uint64_t>(std::abs(x[i])));
    const int exponent = static_cast<int>(largest >> 52);
    // 2^60 / 2^(exponent - 1022) has to be a normal number.
    exact = exponent > 60 && exponent < 2046;
    if (!exact) return;
    const auto scale =
        std::bit_cast<double>(static_cast<std::uint64_t>(2045 + 60 - exponent) << 52);
    int off = 0;
    for (int i = 0; i < N; ++i) {
      const double scaled = x[i] * scale;
      at[i] = static_cast<std::int64_t>(scaled);
      off |= static_cast<double>(at[i]) != scaled;
    }
    // Where the scale is below 1 (the largest is above 2^60), a small number may round to 0, which
    // looks like an integer: only 0 itself may become 0.
    if (exponent > 1082)
      for (int i = 0; i < N; ++i) off |= at[i] == 0 && x[i] != 0;
    exact = off == 0;
  }

  /// Point i, where the coordinates are consecutive points x, y, z.
  std::array<std::int64_t, 3> point(int i) const {
    return {at[3 * i], at[3 * i + 1], at[3 * i + 2]};
  }
};

__extension__ typedef __int128 Int128;

using Fixed3 = std::array<std::int64_t, 3>;

inline Fixed3 operator-(const Fixed3& a, const Fixed3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// The minors u x v of differences below 2^61; they stay below 2^123.
struct FixedNormal {
  Int128 minor[3];

  FixedNormal(const Fixed3& u, const Fixed3& v) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      minor[i] = static_cast<Int128>(u[j]) * v[k] - static_cast<Int128>(u[k]) * v[j];
    }
  }

  /// The sign of its product with a third difference below 2^61. A minor is 2^64 high + low; high
  /// times the difference is below 2^120, low times it below 2^125, and three of either fit.
  int side(const Fixed3& w) const {
    Int128 upper = 0, lower = 0;
    for (int i = 0; i < 3; ++i) {
      upper += static_cast<Int128>(static_cast<std::int64_t>(minor[i] >> 64)) * w[i];
      lower += static_cast<Int128>(static_cast<std::uint64_t>(minor[i])) * w[i];
    }
    upper += lower >> 64;
    if (upper != 0) return upper > 0 ? 1 : -1;
    return static_cast<std::uint64_t>(lower) != 0;
  }
};

/// Calls `f` with a number of limbs that suffices for coordinates of `bits` binary digits. Float64
/// spans 2^-1074 to 2^1024, so 33 limbs always suffice.
template <class F>
int with_limbs(int bits, const F& f) {
  if (bits <= 2 * 64 - 3) return f(std::integral_constant<int, 2>{});
  if (bits <= 5 * 64 - 3) return f(std::integral_constant<int, 5>{});
  return f(std::integral_constant<int, 33>{});
}
static_assert(33 * 64 - 3 >= 1074 + 1024);

[[gnu::noinline]] inline int wide_orientation(const Vec3<double>& a, const Vec3<double>& b,
                                              const Vec3<double>& c, const Vec3<double>& d) {
  BinaryRange range;
  for (const auto* p : {&a, &b, &c, &d})
    for (int i = 0; i < 3; ++i) range.include((*p)[i]);
  return with_limbs(range.bits(), [&](auto limbs) {
    return wide_orientation<limbs()>(a, b, c, d, range.bottom);
  });
}

[[gnu::noinline]] inline int wide_orientation(const Vec3<double>& a, const Vec3<double>& b,
                                              const Vec3<double>& c, int i, int j) {
  BinaryRange range;
  for (const auto* p : {&a, &b, &c}) range.include((*p)[i]), range.include((*p)[j]);
  return with_limbs(range.bits(), [&](auto limbs) {
    return wide_orientation<limbs()>(a.data(), b.data(), c.data(), i, j, range.bottom);
  });
}

[[gnu::noinline]] inline int exact_orientation(const Vec3<double>& a, const Vec3<double>& b,
                                               const Vec3<double>& c, const Vec3<double>& d) {
  const FixedPoint<12> x({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]});
  if (!x.exact) return wide_orientation(a, b, c, d);
  return FixedNormal(x.point(1) - x.point(0), x.point(2) - x.point(0))
      .side(x.point(3) - x.point(0));
}

[[gnu::noinline]] inline int exact_orientation(const Vec3<double>& a, const Vec3<double>& b,
                                               const Vec3<double>& c, int i, int j) {
  const FixedPoint<6> x({a[i], a[j], b[i], b[j], c[i], c[j]});
  if (!x.exact) return wide_orientation(a, b, c, i, j);
  const Int128 left = static_cast<Int128>(x.at[2] - x.at[0]) * (x.at[5] - x.at[1]);
  const Int128 right = static_cast<Int128>(x.at[3] - x.at[1]) * (x.at[4] - x.at[0]);
  return (left > right) - (left < right);
}

}  // namespace detail

/// The sign of det [b-a, c-a, d-a]: 1 where d is on the side of the plane a, b, c from which they
/// appear counterclockwise, 0 where all four points are coplanar, else -1. Exact for finite
/// coordinates.
///
/// Filter: each of three differences carries one rounding (factor 1+u), each of the six triple
/// products two more, the subtraction inside its minor one and the first of the two last sums one;
/// the last sum's own rounding changes no sign. In all that is at most 7u + O(u^2) of the sum P of
/// the magnitudes of the six products, and P as computed is at most 7u + O(u^2) of itself too
/// small, so that (7 + 56 u) u P bounds the error [shewchuk1997adaptive, orient3d's bound A].
/// Range: differences of float64 never underflow. Each product may be off by 2^-1075 more: the two
/// of a minor, which are multiplied by a difference below 2^340 (`reach`), and the three last
/// ones; 2^-700 bounds the sum, in P too. An overflow makes P infinite or NaN, and the integers
/// decide.
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

/// The same in the plane of coordinates i and j: 1 where a, b, c are counterclockwise.
/// Filter: (3 + 16 u) u times the magnitudes [shewchuk1997adaptive, orient2d's bound A], and
/// 2^-1000 for underflow of the two products. Where one overflows, the magnitude is not below
/// 2^1020.
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
