// SPDX-License-Identifier: BSD-3-Clause
/// A vector of four numbers: the register width that every x86-64 has for float.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace bvlab {

namespace detail {
template <class T>
struct FourOf {
  typedef T type __attribute__((vector_size(4 * sizeof(T))));
};
}  // namespace detail

template <class T>
using Four = typename detail::FourOf<T>::type;

/// Bit k is the sign bit of lane k.
template <class V>
inline int signs(const V& v) {
  int bits = 0;
  for (int lane = 0; lane < 4; ++lane) bits |= (std::signbit(v[lane]) ? 1 : 0) << lane;
  return bits;
}
#ifdef __SSE2__
inline int signs(const Four<float>& v) { return _mm_movemask_ps(v); }
#endif
#ifdef __AVX__
inline int signs(const Four<double>& v) { return _mm256_movemask_pd(v); }
#endif

}  // namespace bvlab
