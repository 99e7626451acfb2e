// SPDX-License-Identifier: BSD-3-Clause
/// Numbers from anywhere in memory, one a lane.
#pragma once

#include <cstdint>

#include "hierarchies/geometry/scalar.hpp"

#if defined(__AVX512F__) || defined(__AVX2__)
#include <immintrin.h>
#endif

namespace bvlab {

/// Lane by lane from[index[lane]].
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
  return Batch<float, W>([&](auto lane) { return from[index[lane]]; });
}

}  // namespace bvlab
