// SPDX-License-Identifier: BSD-3-Clause
/// Gathers W volumes from anywhere in an array into one volume over batches. Rows are loaded four
/// scalars at a time and transposed in registers, which is several times cheaper than inserting
/// lane by lane.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "hierarchies/bounding_volume.hpp"

namespace bvlab {

namespace detail {

template <int W>
struct FloatsOf {
  using type [[gnu::vector_size(4 * W)]] = float;
};
/// W floats; arithmetic is never done on these, they are only moved.
template <int W>
using Floats = typename FloatsOf<W>::type;

/// Four floats from each of `row(k)`, `row(k + 4)`, ..., side by side.
template <int W, class Row>
[[gnu::always_inline]] inline Floats<W> side_by_side(const Row& row, int k) {
  if constexpr (W == 4) {
    Floats<4> four;
    std::memcpy(&four, row(k), sizeof four);
    return four;
  } else {
    const auto low = side_by_side<W / 2>(row, k), high = side_by_side<W / 2>(row, k + W / 2);
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return __builtin_shufflevector(low, high, I...);
    }
    (std::make_integer_sequence<int, W>{});
  }
}

/// Within every group of four: a[P], a[Q], b[P], b[Q] (kPairwise) or a[P], b[P], a[Q], b[Q].
template <int W, int P, int Q, bool kPairwise>
[[gnu::always_inline]] inline Floats<W> shuffled(const Floats<W>& a, const Floats<W>& b) {
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return __builtin_shufflevector(a, b,
                                   ((I & ~3) + ((kPairwise ? I & 1 : I >> 1 & 1) ? Q : P) +
                                    ((kPairwise ? I >> 1 & 1 : I & 1) ? W : 0))...);
  }
  (std::make_integer_sequence<int, W>{});
}

/// Fields 0 to 3 of the W rows, one batch of W floats each, to `out`.
template <int W, class Row>
[[gnu::always_inline]] inline void transpose(const Row& row, float* out) {
  // Register k holds rows k, k + 4, k + 8, ...: each group of four is transposed on its own.
  const auto r0 = side_by_side<W>(row, 0), r1 = side_by_side<W>(row, 1);
  const auto r2 = side_by_side<W>(row, 2), r3 = side_by_side<W>(row, 3);
  const auto low01 = shuffled<W, 0, 1, false>(r0, r1), low23 = shuffled<W, 0, 1, false>(r2, r3);
  const auto high01 = shuffled<W, 2, 3, false>(r0, r1), high23 = shuffled<W, 2, 3, false>(r2, r3);
  const Floats<W> columns[4] = {
      shuffled<W, 0, 1, true>(low01, low23), shuffled<W, 2, 3, true>(low01, low23),
      shuffled<W, 0, 1, true>(high01, high23), shuffled<W, 2, 3, true>(high01, high23)};
  std::memcpy(out, columns, sizeof columns);
}

}  // namespace detail

/// Lane i of the result is `base[indices[i]]`. V must be a plain aggregate of its scalars.
template <Batched B, class V>
[[gnu::always_inline]] inline Over<V, B> gather(const V* base, const std::uint32_t* indices) {
  using T = typename V::scalar;
  constexpr int fields = sizeof(V) / sizeof(T), lanes = width<B>();
  static_assert(std::is_standard_layout_v<V> && sizeof(V) % sizeof(T) == 0);
  static_assert(sizeof(Over<V, B>) == sizeof(B) * fields && sizeof(B) == sizeof(T) * lanes);
  Over<V, B> result;
  [[maybe_unused]] T* const out = reinterpret_cast<T*>(&result);
  if constexpr (std::is_same_v<T, float> && lanes >= 4 && fields >= 4) {
    // The last group overlaps the one before where the fields are no multiple of four.
    for (int field = 0; field < fields; field += 4) {
      const int from = std::min(field, fields - 4);
      detail::transpose<lanes>(
          [&](int i) { return reinterpret_cast<const float*>(base + indices[i]) + from; },
          out + from * lanes);
    }
  } else {
    // Filled in an array and copied: a batch may not be written through a T*.
    for (int field = 0; field < fields; ++field) {
      T column[lanes];
      for (int i = 0; i < lanes; ++i)
        column[i] = reinterpret_cast<const T*>(base + indices[i])[field];
      std::memcpy(reinterpret_cast<char*>(&result) + sizeof column * field, column, sizeof column);
    }
  }
  return result;
}

}  // namespace bvlab
