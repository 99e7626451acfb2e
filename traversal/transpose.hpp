// SPDX-License-Identifier: BSD-3-Clause
/// Transposes rows of numbers that lie anywhere in memory into batches, in registers: several times
/// cheaper than inserting lane by lane.
#pragma once

#include <array>
#include <cstring>
#include <utility>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab::detail {

template <class T, int W>
struct LanesOf {
  using type [[gnu::vector_size(sizeof(T) * W)]] = T;
};
/// W numbers, which are only moved and converted, never computed with.
template <class T, int W>
using Lanes = typename LanesOf<T, W>::type;

template <class T, int W>
[[gnu::always_inline]] inline Lanes<T, 2 * W> joined(const Lanes<T, W>& low,
                                                     const Lanes<T, W>& high) {
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return __builtin_shufflevector(low, high, I...);
  }(std::make_integer_sequence<int, 2 * W>{});
}

/// Four numbers from each of `row(k)`, `row(k + 4)`, ..., side by side.
template <class T, int W, class Row>
[[gnu::always_inline]] inline Lanes<T, W> side_by_side(const Row& row, int k) {
  if constexpr (W == 4) {
    Lanes<T, 4> four;
    std::memcpy(&four, row(k), sizeof four);
    return four;
  } else {
    return joined<T, W / 2>(side_by_side<T, W / 2>(row, k), side_by_side<T, W / 2>(row, k + W / 2));
  }
}

/// Within every group of four: a[P], a[Q], b[P], b[Q] (kPairwise) or a[P], b[P], a[Q], b[Q].
template <class T, int W, int P, int Q, bool kPairwise>
[[gnu::always_inline]] inline Lanes<T, W> shuffled(const Lanes<T, W>& a, const Lanes<T, W>& b) {
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return __builtin_shufflevector(a, b,
                                   ((I & ~3) + ((kPairwise ? I & 1 : I >> 1 & 1) ? Q : P) +
                                    ((kPairwise ? I >> 1 & 1 : I & 1) ? W : 0))...);
  }(std::make_integer_sequence<int, W>{});
}

/// The first four numbers of each of W rows, to the k-th of which row(k) points: W of each.
template <class T, int W, class Row>
[[gnu::always_inline]] inline std::array<Lanes<T, W>, 4> columns_of(const Row& row) {
  // One instruction interleaves fields 0 and 2 of doubles, 0 and 1 of floats.
  constexpr int step = sizeof(T) == 8 ? 2 : 1, other = 3 - step;
  // Register k holds rows k, k + 4, k + 8, ...: each group of four is transposed on its own.
  const auto r0 = side_by_side<T, W>(row, 0), r1 = side_by_side<T, W>(row, 1);
  const auto r2 = side_by_side<T, W>(row, 2), r3 = side_by_side<T, W>(row, 3);
  const auto first01 = shuffled<T, W, 0, step, false>(r0, r1),
             first23 = shuffled<T, W, 0, step, false>(r2, r3),
             second01 = shuffled<T, W, other, 3, false>(r0, r1),
             second23 = shuffled<T, W, other, 3, false>(r2, r3);
  std::array<Lanes<T, W>, 4> columns;
  columns[0] = shuffled<T, W, 0, 1, true>(first01, first23);
  columns[step] = shuffled<T, W, 2, 3, true>(first01, first23);
  columns[other] = shuffled<T, W, 0, 1, true>(second01, second23);
  columns[3] = shuffled<T, W, 2, 3, true>(second01, second23);
  return columns;
}

/// The same numbers as a batch. It goes through memory, which compilers optimise away.
template <class S, class L>
[[gnu::always_inline]] inline S batch_from(const L& lanes) {
  static_assert(sizeof(L) == sizeof(Element<S>) * width<S>());
  alignas(64) Element<S> number[width<S>()];
  std::memcpy(number, &lanes, sizeof lanes);
  return S(number, stdx::vector_aligned);
}

}  // namespace bvlab::detail
