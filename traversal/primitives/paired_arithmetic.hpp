// SPDX-License-Identifier: BSD-3-Clause
/// Double-word arithmetic, on unevaluated sums of two numbers of S, lane by lane: error-free sums,
/// differences and products (TwoSum, TwoProduct), and minors and determinants with their rounding
/// errors. triangle_refinement.hpp bounds the remaining error.
#pragma once

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include <array>
#include <cmath>

#include "traversal/primitives/triangle_filter.hpp"

namespace bvlab {

namespace filter {

/// The unevaluated sum of two numbers.
template <Scalar S>
struct Pair {
  S high, low;
};

/// a - b, exactly.
template <Scalar S>
[[gnu::always_inline]] inline Pair<S> exact_difference(const S& a, const S& b) {
  const S d = a - b, t = d - a;
  return {d, (a - (d - t)) - (b + t)};
}

/// a + b, exactly.
template <Scalar S>
[[gnu::always_inline]] inline Pair<S> exact_sum(const S& a, const S& b) {
  const S s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}

/// The rounding error of `product`, which is a * b rounded, without fused multiply-adds
/// (dekker1971floating); exact where nothing under- or overflows.
template <Scalar S>
[[gnu::always_inline]] inline S lost_in_product_by_parts(const S& a, const S& b, const S& product) {
  using T = Element<S>;
  constexpr T splitter = sizeof(T) == 8 ? T(0x1p27 + 1) : T(0x1p12 + 1);
  const S ca = S(splitter) * a, cb = S(splitter) * b;
  const S ah = ca - (ca - a), bh = cb - (cb - b), al = a - ah, bl = b - bh;
  return ((ah * bh - product) + ah * bl + al * bh) + al * bl;
}

/// The same, by a fused multiply-add where the processor has one.
template <Scalar S>
[[gnu::always_inline]] inline S lost_in_product(const S& a, const S& b, const S& product) {
#if defined(__AVX512F__)
  if constexpr (Batched<S> && width<S>() == 8 && sizeof(Element<S>) == 8)
    return S(_mm512_fmsub_pd(static_cast<__m512d>(a), static_cast<__m512d>(b),
                             static_cast<__m512d>(product)));
#endif
#if defined(__FMA__)
  if constexpr (!Batched<S>) return std::fma(a, b, -product);
#endif
  return lost_in_product_by_parts<S>(a, b, product);
}

/// a * b, exactly.
template <Scalar S>
[[gnu::always_inline]] inline Pair<S> exact_product(const S& a, const S& b) {
  const S p = a * b;
  return {p, lost_in_product<S>(a, b, p)};
}

template <Scalar S>
using PairVector = std::array<Pair<S>, 3>;

template <Scalar S>
[[gnu::always_inline]] inline PairVector<S> exact_difference(const Vector<S>& a,
                                                             const Vector<S>& b) {
  return {exact_difference<S>(a[0], b[0]), exact_difference<S>(a[1], b[1]),
          exact_difference<S>(a[2], b[2])};
}

template <Scalar S>
[[gnu::always_inline]] inline PairVector<S> operator-(const PairVector<S>& v) {
  return {{{-v[0].high, -v[0].low}, {-v[1].high, -v[1].low}, {-v[2].high, -v[2].low}}};
}

/// a d - b c.
template <Scalar S>
[[gnu::always_inline]] inline Pair<S> minor(const Pair<S>& a, const Pair<S>& b, const Pair<S>& c,
                                            const Pair<S>& d) {
  const Pair<S> p = exact_product<S>(a.high, d.high), q = exact_product<S>(b.high, c.high);
  const Pair<S> s = exact_difference<S>(p.high, q.high);
  const S mixed = (a.high * d.low + a.low * d.high) - (b.high * c.low + b.low * c.high);
  return {s.high, mixed + ((p.low - q.low) + s.low)};
}

template <Scalar S>
[[gnu::always_inline]] inline PairVector<S> cross(const PairVector<S>& u, const PairVector<S>& v) {
  return {minor<S>(u[1], u[2], v[1], v[2]), minor<S>(u[2], u[0], v[2], v[0]),
          minor<S>(u[0], u[1], v[0], v[1])};
}

template <Scalar S>
[[gnu::always_inline]] inline S dot(const PairVector<S>& n, const PairVector<S>& w) {
  const auto lost = [&](int k, const Pair<S>& p) {
    return p.low + (n[k].high * w[k].low + n[k].low * w[k].high);
  };
  const Pair<S> x = exact_product<S>(n[0].high, w[0].high);
  const Pair<S> y = exact_product<S>(n[1].high, w[1].high);
  const Pair<S> z = exact_product<S>(n[2].high, w[2].high);
  const Pair<S> xy = exact_sum<S>(x.high, y.high), xyz = exact_sum<S>(xy.high, z.high);
  return xyz.high + (((lost(0, x) + lost(1, y)) + lost(2, z)) + (xy.low + xyz.low));
}

}  // namespace filter

}  // namespace bvlab
