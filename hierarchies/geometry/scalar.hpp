// SPDX-License-Identifier: BSD-3-Clause
/// The scalar `S` of a volume: float, double, or a SIMD batch of either.
///
/// A batch holds W independent problems, one per lane. Code written over `S` uses `+ - * /`,
/// `sqrt`, `min`, `max` and comparisons; a comparison gives `Mask<S>`, which is `bool` for one
/// problem and one bit per lane for a batch.
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
#endif

// Bounds on rounding, infinities and NaN are relied on. What clang does not tell of itself is
// -funsafe-math-optimizations without the rest.
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

/// W values of type T in vector registers. Keep to one register (`native_width`): GCC 12 at -O3
/// takes comparisons of sixteen doubles, which fill two, for true where they are not.
template <class T, int W>
using Batch = stdx::simd<T, stdx::simd_abi::deduce_t<T, W>>;

/// As many as one vector register holds.
template <class T>
constexpr int native_width = static_cast<int>(stdx::native_simd<T>::size());

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

/// What a comparison of two `S` gives.
template <Scalar S>
using Mask = decltype(std::declval<S>() < std::declval<S>());

/// Number of problems held by one `S`.
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
  else  // the only name we use of libstdc++'s own: it has had it from 11 on
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

/// Half the distance from 1 to the next number: one rounded operation is off by at most this
/// factor, so long as nothing underflows.
template <class T>
constexpr Element<T> unit_roundoff = std::numeric_limits<Element<T>>::epsilon() / 2;

/// The next larger (smaller) number; infinity stays where it is.
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

/// A float (or double) that is not below (not above) `x`.
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

/// Products and sums in this order, so that a batch gives lane by lane what a scalar gives.
template <class S>
[[gnu::always_inline]] inline S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}
template <class S>
[[gnu::always_inline]] inline S squared_norm(const Vec3<S>& v) {
  return dot(v, v);
}

/// A vector rounded to T, to nearest: off by at most half a last digit, or half the least number,
/// and infinite beyond the largest. A volume about an infinite centre has an infinite radius or
/// none that is a number, and is disjoint from nothing.
///
/// The result is hidden from the optimiser: GCC 12 at -O2 takes a pair of doubles through float and
/// back without rounding them (its SLP vectoriser merges the two conversions), and a volume whose
/// radius is measured from a centre that it does not hold encloses nothing.
template <class T>
Vec3<T> rounded(const Vec3<double>& v) {
  Vec3<T> result = v.template cast<T>();
#if defined(__GNUC__)
  asm("" : "+m"(result));
#endif
  return result;
}

}  // namespace bvlab
