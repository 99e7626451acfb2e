// SPDX-License-Identifier: BSD-3-Clause
/// Operations on SIMD lanes of volumes: fused multiply-adds, access to the volume in one lane of a
/// batch, one volume broadcast to all lanes, the numbers of set lanes, and a loop over the
/// registers of a step.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "hierarchies/bounding_volume.hpp"

#if defined(__AVX512F__) || defined(__FMA__)
#include <immintrin.h>
#endif

namespace bvlab {

namespace detail {

/// Whether `fused` rounds once: for batches of four floats or more where x86 has FMA, and where
/// BVLAB_FUSED says that this processor, which has none, is to count as one that has (as by
/// BVLAB_REGISTER_BYTES).
template <Scalar S>
constexpr bool counted_as_fused =
#if defined(BVLAB_FUSED)
    std::is_same_v<Element<S>, float> && width<S>() >= 4;
#else
    false;
#endif

/// a * b + c for BVLAB_FUSED. WebAssembly's relaxed lanes round as the processor does: who runs
/// them asks first. Without them the product is exact in double, and all but one sum in 2^29 is
/// rounded as if once.
template <Batched S>
[[gnu::always_inline]] inline S once_rounded(const S& a, const S& b, const S& c) {
#if defined(__wasm_relaxed_simd__)
  using Four [[gnu::vector_size(16)]] = float;
  using Fours = std::array<Four, S::size() / 4>;
  const auto fours = [](const S& x) { return std::bit_cast<Fours>(x); };
  const Fours x = fours(a), y = fours(b), z = fours(c);
  Fours sum;
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] = __builtin_wasm_relaxed_madd_f32x4(x[i], y[i], z[i]);
  return std::bit_cast<S>(sum);
#else
  using Wide = Batch<double, width<S>()>;
  const auto wide = [](const S& x) { return stdx::static_simd_cast<Wide>(x); };
  return stdx::static_simd_cast<S>(wide(a) * wide(b) + wide(c));
#endif
}

}  // namespace detail

/// a * b + c, rounded once for batches of floats where x86 has FMA, else twice. Only for results
/// whose error bound covers both; never for the exact position of a vertex.
template <Scalar S>
[[gnu::always_inline]] inline S fused(const S& a, const S& b, const S& c) {
#if defined(__AVX512F__)
  if constexpr (std::is_same_v<S, Batch<float, 16>>)
    return S(
        _mm512_fmadd_ps(static_cast<__m512>(a), static_cast<__m512>(b), static_cast<__m512>(c)));
#endif
#if defined(__FMA__)
  if constexpr (std::is_same_v<S, Batch<float, 8>>)
    return S(
        _mm256_fmadd_ps(static_cast<__m256>(a), static_cast<__m256>(b), static_cast<__m256>(c)));
  if constexpr (std::is_same_v<S, Batch<float, 4>>)
    return S(_mm_fmadd_ps(static_cast<__m128>(a), static_cast<__m128>(b), static_cast<__m128>(c)));
#endif
  if constexpr (detail::counted_as_fused<S>)
    return detail::once_rounded<S>(a, b, c);
  else
    return a * b + c;
}

/// c - a * b, rounded as `fused` is.
template <Scalar S>
[[gnu::always_inline]] inline S less_fused(const S& a, const S& b, const S& c) {
#if defined(__AVX512F__)
  if constexpr (std::is_same_v<S, Batch<float, 16>>)
    return S(
        _mm512_fnmadd_ps(static_cast<__m512>(a), static_cast<__m512>(b), static_cast<__m512>(c)));
#endif
#if defined(__FMA__)
  if constexpr (std::is_same_v<S, Batch<float, 8>>)
    return S(
        _mm256_fnmadd_ps(static_cast<__m256>(a), static_cast<__m256>(b), static_cast<__m256>(c)));
  if constexpr (std::is_same_v<S, Batch<float, 4>>)
    return S(_mm_fnmadd_ps(static_cast<__m128>(a), static_cast<__m128>(b), static_cast<__m128>(c)));
#endif
  if constexpr (detail::counted_as_fused<S>)
    return detail::once_rounded<S>(-a, b, c);
  else
    return c - a * b;
}

/// 1 / x; in AVX-512 with a relative error up to 2^-14. Only for the order of pairs.
template <Scalar S>
[[gnu::always_inline]] inline S roughly_one_over(const S& x) {
#if defined(__AVX512F__)
  if constexpr (std::is_same_v<S, Batch<float, 16>>)
    return S(_mm512_rcp14_ps(static_cast<__m512>(x)));
#endif
  return S(1) / x;
}

[[gnu::always_inline]] inline Batch<float, 4> rounded_to_float(const Batch<double, 4>& v) {
  return stdx::static_simd_cast<Batch<float, 4>>(v);
}

namespace detail {

/// Writes value(k) for each set bit k of the mask, side by side, and returns how many. There must
/// be room for F. Every lane is written, and the next one overwrites it where its bit is not set: a
/// loop over the set bits would end at a branch that cannot be predicted.
template <int F, class T, class Value>
[[gnu::always_inline]] inline std::size_t write_set_lanes(T* out, std::uint64_t mask,
                                                          Value&& value) {
  std::size_t count = 0;
  for (int k = 0; k < F; ++k) {
    out[count] = value(k);
    count += mask >> k & 1;
  }
  return count;
}

/// Writes first + k for each set bit k of the mask, in order, and returns how many. There must be
/// room for F numbers.
template <int F>
[[gnu::always_inline]] inline std::size_t write_numbers(std::uint32_t* out, std::uint64_t mask,
                                                        std::uint32_t first) {
#if defined(__AVX512F__) && defined(__AVX512VL__)
  const auto count = static_cast<std::size_t>(std::popcount(mask));
  if constexpr (F == 16) {
    const __m512i lanes = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    const __m512i all = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)), lanes);
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), all));
    return count;
  }
  if constexpr (F == 8) {
    const __m256i lanes = _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    const __m256i all = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)), lanes);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), all));
    return count;
  }
#endif
  return write_set_lanes<F>(out, mask,
                            [first](int k) { return first + static_cast<std::uint32_t>(k); });
}

/// The number of lanes. Volumes are plain aggregates of scalars, stored field by field.
template <class V, class Lanes>
constexpr int lanes_of = sizeof(Lanes) / sizeof(V);

}  // namespace detail

/// Writes `volume` into one lane.
template <class Lanes, class V>
void put_lane(Lanes& lanes, int lane, const V& volume) {
  using T = typename V::scalar;
  constexpr int fields = sizeof(V) / sizeof(T), width = detail::lanes_of<V, Lanes>;
  static_assert(std::is_standard_layout_v<V> && sizeof(Lanes) == sizeof(T) * fields * width);
  for (int field = 0; field < fields; ++field)
    std::memcpy(reinterpret_cast<char*>(&lanes) + sizeof(T) * (field * width + lane),
                reinterpret_cast<const char*>(&volume) + sizeof(T) * field, sizeof(T));
}

/// The volume in one lane.
template <class V, class Lanes>
V lane_of(const Lanes& lanes, int lane) {
  using T = typename V::scalar;
  constexpr int fields = sizeof(V) / sizeof(T), width = detail::lanes_of<V, Lanes>;
  V volume;
  for (int field = 0; field < fields; ++field)
    std::memcpy(reinterpret_cast<char*>(&volume) + sizeof(T) * field,
                reinterpret_cast<const char*>(&lanes) + sizeof(T) * (field * width + lane),
                sizeof(T));
  return volume;
}

/// Calls `what(part)` for the registers of a step of `parts` registers of S, whose `lanes` are in
/// use. Up to four are unrolled: a loop, even of one pass, would keep its results in memory. Of
/// more, those without a lane in use are left out.
template <Batched S, std::size_t parts, class Do>
[[gnu::always_inline]] inline void for_each_part([[maybe_unused]] std::uint64_t lanes, Do&& what) {
  if constexpr (parts <= 4) {
    [&]<std::size_t... part>(std::index_sequence<part...>) __attribute__((always_inline)) {
      (what(part), ...);
    }
    (std::make_index_sequence<parts>());
  } else {
    constexpr std::uint64_t all = (std::uint64_t{1} << S::size()) - 1;
    for (std::size_t part = 0; part < parts; ++part)
      if (lanes >> (part * S::size()) & all) what(part);
  }
}

/// The same volume in every lane of S.
template <Batched S, class V>
[[gnu::always_inline]] inline Over<V, S> in_all_lanes(const V& volume) {
  using T = typename V::scalar;
  constexpr int fields = sizeof(V) / sizeof(T);
  static_assert(sizeof(Over<V, S>) == sizeof(S) * fields);
  Over<V, S> result;
  for (int field = 0; field < fields; ++field) {
    T x;
    std::memcpy(&x, reinterpret_cast<const char*>(&volume) + sizeof x * field, sizeof x);
    const S all(x);
    std::memcpy(reinterpret_cast<char*>(&result) + sizeof all * field, &all, sizeof all);
  }
  return result;
}

}  // namespace bvlab
