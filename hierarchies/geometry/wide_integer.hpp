// SPDX-License-Identifier: BSD-3-Clause
/// A signed integer of 64 N bits, two's complement: exact sums and products for the few
/// predicates that floating point leaves open. Cost: N^2 machine multiplications a product.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace bvlab {

/// The binary range of the numbers included: each is an integer multiple of 2^bottom and below
/// 2^top in magnitude, `top` being the least such exponent. Zero constrains neither.
struct BinaryRange {
  int bottom = 1 << 20;
  int top = -(1 << 20);

  void include(double x) {
    if (x == 0) return;
    int exponent;
    const double fraction = std::frexp(std::abs(x), &exponent);
    const auto digits = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    const int lowest = exponent - 53 + __builtin_ctzll(digits);
    if (lowest < bottom) bottom = lowest;
    if (exponent > top) top = exponent;
  }
  int bits() const { return top > bottom ? top - bottom : 0; }
};

template <int N>
struct WideInteger {
  std::array<std::uint64_t, N> limb{};  ///< least significant first

  /// x / 2^bottom, which must be an integer of fewer than 64 N bits.
  static WideInteger scaled(double x, int bottom) {
    WideInteger result;
    if (x == 0) return result;
    int exponent;
    const double fraction = std::frexp(std::abs(x), &exponent);
    auto digits = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    int shift = exponent - 53 - bottom;
    if (shift < 0) digits >>= -shift, shift = 0;  // those digits are zero
    result.limb[shift / 64] = digits << (shift % 64);
    if (shift % 64 != 0 && shift / 64 + 1 < N)
      result.limb[shift / 64 + 1] = digits >> (64 - shift % 64);
    return x < 0 ? -result : result;
  }

  bool negative() const { return static_cast<std::int64_t>(limb[N - 1]) < 0; }

  /// -1, 0 or 1.
  int sign() const {
    if (negative()) return -1;
    for (const std::uint64_t part : limb)
      if (part != 0) return 1;
    return 0;
  }

  WideInteger operator-() const { return WideInteger{} - *this; }

  friend WideInteger operator+(const WideInteger& a, const WideInteger& b) {
    WideInteger sum;
    Double carry = 0;
    for (int i = 0; i < N; ++i) {
      carry += static_cast<Double>(a.limb[i]) + b.limb[i];
      sum.limb[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }
  friend WideInteger operator-(const WideInteger& a, const WideInteger& b) {
    WideInteger difference;
    std::uint64_t borrow = 0;
    for (int i = 0; i < N; ++i) {
      const Double part = static_cast<Double>(a.limb[i]) - b.limb[i] - borrow;
      difference.limb[i] = static_cast<std::uint64_t>(part);
      borrow = static_cast<std::uint64_t>(part >> 64) & 1;
    }
    return difference;
  }

 private:
  __extension__ typedef unsigned __int128 Double;
};

/// The exact product.
template <int N, int M>
WideInteger<N + M> operator*(const WideInteger<N>& a, const WideInteger<M>& b) {
  __extension__ typedef unsigned __int128 Double;
  WideInteger<N + M> product;
  for (int i = 0; i < N; ++i) {
    std::uint64_t carry = 0;
    for (int j = 0; j < M; ++j) {
      const Double part = static_cast<Double>(a.limb[i]) * b.limb[j] + product.limb[i + j] + carry;
      product.limb[i + j] = static_cast<std::uint64_t>(part);
      carry = static_cast<std::uint64_t>(part >> 64);
    }
    product.limb[i + M] = carry;
  }
  // The factors were read as unsigned: a negative one as itself plus 2^(64 N).
  const auto subtract_high = [&](const auto& limbs, int from) {
    std::uint64_t borrow = 0;
    for (int i = from; i < N + M; ++i) {
      const Double part = static_cast<Double>(product.limb[i]) - limbs[i - from] - borrow;
      product.limb[i] = static_cast<std::uint64_t>(part);
      borrow = static_cast<std::uint64_t>(part >> 64) & 1;
    }
  };
  if (a.negative()) subtract_high(b.limb, N);
  if (b.negative()) subtract_high(a.limb, M);
  return product;
}

}  // namespace bvlab
