// SPDX-License-Identifier: BSD-3-Clause
/// Gathers numbers from anywhere in memory, one per lane.
#pragma once

#include <cstdint>
#include <cstring>

#include "hierarchies/geometry/scalar.hpp"

#if defined(__AVX512F__) || defined(__AVX2__)
#include <immintrin.h>
#endif

namespace bvlab {

/// Lane by lane, from[index[lane]]. The numbers may be integers of four bytes: bits are copied,
/// never read as floats.
template <int W>
[[gnu::always_inline]] inline Batch<float, W> gathered(const float* from,
                                                       const Batch<std::int32_t, W>& index) {
#if defined(__AVX512F__)
  if constexpr (W == 16)
    return Batch<float, W>(_mm512_i32gather_ps(static_cast<__m512i>(index), from, 4));
#endif
#if defined(__AVX2__)
  if constexpr (W == 8)
    return Batch<float, W>(_mm256_i32gather_ps(from, static_cast<__m256i>(index), 4));
#endif
  return Batch<float, W>([&](auto lane) {
    float x;
    std::memcpy(&x, reinterpret_cast<const char*>(from) + sizeof x * index[lane], sizeof x);
    return x;
  });
}

}  // namespace bvlab
