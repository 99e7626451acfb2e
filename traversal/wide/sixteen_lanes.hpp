// SPDX-License-Identifier: BSD-3-Clause
/// Sixteen lanes in as many registers as they need: part `p` is lanes p W and up, W being the
/// width of a register. Two sets of four numbers are spread over sixteen lanes so that each number
/// of one meets each of the other: lane 4 i + j has number i of the first and number j of the
/// second.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hierarchies/geometry/scalar.hpp"
#include "traversal/wide/work_queue.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace bvlab {

using SixteenLanes = Batch<float, (native_width<float> < 16 ? native_width<float> : 16)>;

/// Number i in lanes 4 i to 4 i + 3. Here and below, four numbers are 16-byte aligned,
/// sixteen 64-byte aligned.
[[gnu::always_inline]] inline SixteenLanes each_of_four(const float* four,
                                                        [[maybe_unused]] std::size_t part) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (SixteenLanes::size() == 16) {
    const __m512i index = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
    return SixteenLanes(_mm512_permutexvar_ps(index, _mm512_castps128_ps512(_mm_load_ps(four))));
  }
#elif defined(__AVX__)
  if constexpr (SixteenLanes::size() == 8)
    return SixteenLanes(
        _mm256_set_m128(_mm_set1_ps(four[2 * part + 1]), _mm_set1_ps(four[2 * part])));
#endif
  constexpr std::size_t W = SixteenLanes::size();
  if constexpr (W <= 4)
    return SixteenLanes(four[W * part / 4]);
  else
    return SixteenLanes([&](auto lane) { return four[(W * part + lane) / 4]; });
}

/// Number j in lanes j, j + 4, j + 8 and j + 12.
[[gnu::always_inline]] inline SixteenLanes four_repeated(const float* four,
                                                         [[maybe_unused]] std::size_t part) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (SixteenLanes::size() == 16)
    return SixteenLanes(_mm512_broadcast_f32x4(_mm_load_ps(four)));
#elif defined(__AVX__)
  if constexpr (SixteenLanes::size() == 8)
    return SixteenLanes(_mm256_broadcast_ps(reinterpret_cast<const __m128*>(four)));
#endif
  constexpr std::size_t W = SixteenLanes::size();
  if constexpr (W <= 4)
    return SixteenLanes(four + W * part % 4, stdx::element_aligned);
  else
    return SixteenLanes([&](auto lane) { return four[lane % 4]; });
}

[[gnu::always_inline]] inline SixteenLanes of_sixteen(const float* lanes, std::size_t part) {
  return SixteenLanes(lanes + SixteenLanes::size() * part, stdx::vector_aligned);
}

[[gnu::always_inline]] inline NodesOfLanes each_of_four(const std::uint32_t* four) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  const __m512i index = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
  return (NodesOfLanes)_mm512_permutexvar_epi32(
      index, _mm512_castsi128_si512(_mm_load_si128(reinterpret_cast<const __m128i*>(four))));
#else
  NodesOfLanes all;
  for (std::size_t lane = 0; lane < 16; ++lane) all[lane] = four[lane / 4];
  return all;
#endif
}

[[gnu::always_inline]] inline NodesOfLanes four_repeated(const std::uint32_t* four) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return (NodesOfLanes)_mm512_broadcast_i32x4(
      _mm_load_si128(reinterpret_cast<const __m128i*>(four)));
#else
  NodesOfLanes all;
  for (std::size_t lane = 0; lane < 16; ++lane) all[lane] = four[lane % 4];
  return all;
#endif
}

[[gnu::always_inline]] inline NodesOfLanes of_sixteen(const std::uint32_t* lanes) {
  NodesOfLanes all;
  __builtin_memcpy(&all, lanes, sizeof all);
  return all;
}

/// Bit k is the highest bit of lane k.
[[gnu::always_inline]] inline std::uint64_t highest_bits(const NodesOfLanes& lanes) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_movepi32_mask((__m512i)lanes);
#else
  std::uint64_t bits = 0;
  for (std::size_t lane = 0; lane < 16; ++lane) bits |= std::uint64_t{lanes[lane] >> 31} << lane;
  return bits;
#endif
}

/// The lanes of the pairs of four numbers with four others, number i of `a` with number k of `b` in
/// lane 4 i + k, of which both are in use. `a` and `b` have a bit for each number in use.
[[gnu::always_inline]] inline std::uint64_t four_by_four(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t rows = (a & 1) | (a & 2) << 3 | (a & 4) << 6 | (a & 8) << 9;
  return rows * 15 & b * 0x1111u;
}

}  // namespace bvlab
