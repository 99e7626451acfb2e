// SPDX-License-Identifier: BSD-3-Clause
/// The scalar type `S` of a volume: float, double, or a SIMD batch of either.
///
/// A batch holds W independent problems, one per lane. Code over `S` uses `+ - * /`, `sqrt`, `min`,
/// `max` and comparisons; a comparison returns a `Mask<S>`: a `bool` for a scalar, one bit per lane
/// for a batch.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(BVLAB_ONE_LANE)
#include "hierarchies/geometry/one_lane.hpp"
#elif defined(__clang__)
#include "hierarchies/geometry/vector_lanes.hpp"
#else
#include <experimental/simd>
#include <utility>
#endif

// The error bounds need IEEE rounding, infinities and NaN. This catches all but clang's
// -funsafe-math-optimizations alone, of which clang defines no macro.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "bvlab: answers are wrong under -ffast-math, -Ofast and what they stand for: compile without"
#endif

namespace bvlab {

#if defined(BVLAB_ONE_LANE)
namespace stdx = one_lane;
#elif defined(__clang__)
namespace stdx = vector_lanes;
#else
namespace stdx = std::experimental;
#endif

/// W values of type T in vector registers. Use at most one register (`native_width`): GCC 12 at -O3
/// miscompiles comparisons of sixteen doubles, which fill two (false lanes become true).
template <class T, int W>
using Batch = stdx::simd<T, stdx::simd_abi::deduce_t<T, W>>;

/// The number of values that one vector register holds.
template <class T>
constexpr int native_width = static_cast<int>(stdx::native_simd<T>::size());

/// As many lanes as a register holds, but at least four; one where there are no registers.
template <class T>
using NativeBatch =
    Batch<T, native_width<T> == 1 ? 1 : (native_width<T> > 4 ? native_width<T> : 4)>;

template <class S>
concept Batched = stdx::is_simd_v<S>;

namespace detail {
template <class S>
struct ElementOf {
  using type = S;
};
template <Batched S>
struct ElementOf<S> {
  using type = typename S::value_type;
};
}  // namespace detail

/// The floating-point type of one lane.
template <class S>
using Element = typename detail::ElementOf<S>::type;

template <class S>
concept Scalar = std::is_floating_point_v<Element<S>>;

/// The result type of a comparison of two `S`.
template <Scalar S>
using Mask = decltype(std::declval<S>() < std::declval<S>());

/// The number of lanes of `S`; 1 for a scalar.
template <Scalar S>
constexpr int width() {
  if constexpr (Batched<S>)
    return static_cast<int>(S::size());
  else
    return 1;
}

/// Bit i is set where lane i of the mask is true.
inline std::uint64_t bits(bool mask) { return mask ? 1u : 0u; }
template <class T, class Abi>
[[gnu::always_inline]] inline std::uint64_t bits(const stdx::simd_mask<T, Abi>& mask) {
  if constexpr (requires { mask.bits(); })
    return mask.bits();
  else  // the only internal name of libstdc++ used here; there since 11
    return mask.__to_bitset().to_ullong();
}

/// `condition ? yes : no`, lane by lane.
template <class T>
  requires std::is_floating_point_v<T>
T select(bool condition, T yes, T no) {
  return condition ? yes : no;
}
template <Batched S>
[[gnu::always_inline]] inline S select(const typename S::mask_type& condition, const S& yes,
                                       const S& no) {
  S result = no;
  stdx::where(condition, result) = yes;
  return result;
}

/// The unit roundoff: half the distance from 1 to the next number. One rounded operation has at
/// most this relative error, unless it underflows.
template <class T>
constexpr Element<T> unit_roundoff = std::numeric_limits<Element<T>>::epsilon() / 2;

/// The next larger (smaller) number; an infinity in that direction is unchanged.
template <class T>
  requires std::is_floating_point_v<T>
T next_up(T x) {
  return std::nextafter(x, std::numeric_limits<T>::infinity());
}
template <class T>
  requires std::is_floating_point_v<T>
T next_down(T x) {
  return std::nextafter(x, -std::numeric_limits<T>::infinity());
}

/// `x` rounded to T, but not below (not above) `x`.
template <class T>
T rounded_up(double x) {
  const T y = static_cast<T>(x);
  return static_cast<double>(y) < x ? next_up(y) : y;
}
template <class T>
T rounded_down(double x) {
  const T y = static_cast<T>(x);
  return static_cast<double>(y) > x ? next_down(y) : y;
}

template <class S>
using Vec3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Mat3 = Eigen::Matrix<S, 3, 3>;

/// Always in this order, so that a batch gives lane by lane what a scalar gives.
template <class S>
[[gnu::always_inline]] inline S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}
template <class S>
[[gnu::always_inline]] inline S squared_norm(const Vec3<S>& v) {
  return dot(v, v);
}

/// A vector rounded to the nearest T: the error is at most half a unit in the last place, or half
/// the smallest number; infinite on overflow. A volume with an infinite centre has a radius that is
/// infinite or NaN, and is disjoint from nothing.
///
/// The `asm` hides the result from the optimiser: GCC 12 at -O2 converts a pair of doubles to float
/// and back without rounding (its SLP vectoriser merges the two conversions), and a radius measured
/// from an unrounded centre would not enclose the points.
template <class T>
Vec3<T> rounded(const Vec3<double>& v) {
  Vec3<T> result = v.template cast<T>();
#if defined(__GNUC__)
  asm("" : "+m"(result));
#endif
  return result;
}

}  // namespace bvlab
