// SPDX-License-Identifier: BSD-3-Clause
/// Gathers the corners of W triangles from anywhere in memory into batches, one triangle a lane:
/// nine numbers each, loaded four at a time and transposed in registers, about 3 ns a triangle
/// faster than one by one.
#pragma once

#include <cstring>
#include <utility>

#include "hierarchies/geometry/scalar.hpp"
#include "traversal/primitives/triangle_filter.hpp"

namespace bvlab {

namespace detail {

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

/// Within every group of four lanes: a[P], b[P], a[Q], b[Q] (kPairs = 1), or a[P], a[Q], b[P],
/// b[Q].
template <int W, int P, int Q, int kPairs>
[[gnu::always_inline]] inline Lanes<double, W> mixed(const Lanes<double, W>& a,
                                                     const Lanes<double, W>& b) {
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    constexpr auto from = [](int i) {
      const int group = i / 4 * 4, k = i % 4;
      const bool of_b = kPairs ? k % 2 == 1 : k >= 2;
      const bool second = kPairs ? k >= 2 : k % 2 == 1;
      return group + (second ? Q : P) + (of_b ? W : 0);
    };
    return __builtin_shufflevector(a, b, from(I)...);
  }(std::make_integer_sequence<int, W>{});
}

/// Reads four numbers from each of eight rows; `column[c]` gets the c-th of every row.
[[gnu::always_inline]] inline void transpose_four(const double* const* rows, int offset,
                                                  Lanes<double, 8>* column) {
  constexpr int W = 8;
  Lanes<double, W> row[4];
  for (int k = 0; k < 4; ++k) {
    Lanes<double, 4> four, more;
    std::memcpy(&four, rows[k] + offset, sizeof four);
    std::memcpy(&more, rows[k + 4] + offset, sizeof more);
    row[k] = joined<double, 4>(four, more);
  }
  // a0 b0 a2 b2 and a1 b1 a3 b3, of rows 0 1 and of rows 2 3; then halves of groups.
  const auto even_01 = mixed<W, 0, 2, 1>(row[0], row[1]),
             odd_01 = mixed<W, 1, 3, 1>(row[0], row[1]);
  const auto even_23 = mixed<W, 0, 2, 1>(row[2], row[3]),
             odd_23 = mixed<W, 1, 3, 1>(row[2], row[3]);
  column[0] = mixed<W, 0, 1, 0>(even_01, even_23);
  column[1] = mixed<W, 0, 1, 0>(odd_01, odd_23);
  column[2] = mixed<W, 2, 3, 0>(even_01, even_23);
  column[3] = mixed<W, 2, 3, 0>(odd_01, odd_23);
}

/// The nine coordinates of 8 triangles, one batch for each coordinate.
[[gnu::always_inline]] inline void transpose_corners(const Triangle* const* triangles,
                                                     Lanes<double, 8>* column) {
  const double* rows[8];
  for (int k = 0; k < 8; ++k) rows[k] = (*triangles[k])[0].data();
  transpose_four(rows, 0, column);
  transpose_four(rows, 4, column + 4);
  column[8] = Lanes<double, 8>{rows[0][8], rows[1][8], rows[2][8], rows[3][8],
                               rows[4][8], rows[5][8], rows[6][8], rows[7][8]};
}

template <class S, class L>
[[gnu::always_inline]] inline S batch_from(const L& lanes) {
  static_assert(sizeof(L) == sizeof(Element<S>) * width<S>());
  alignas(64) Element<S> number[width<S>()];
  std::memcpy(number, &lanes, sizeof lanes);
  return S(number, stdx::vector_aligned);
}

static_assert(sizeof(Triangle) == 9 * sizeof(double));

/// The corners of W triangles, one triangle a lane, rounded to the element of S.
template <Batched S>
[[gnu::always_inline]] inline Corners<S> gathered(const Triangle* const* triangles) {
  using T = Element<S>;
  constexpr int W = width<S>();
  Corners<S> corners;
  if constexpr (sizeof(T) * W < 64) {
    for (int i = 0; i < 9; ++i)
      corners[i / 3][i % 3] =
          S([&](auto lane) { return static_cast<T>((*triangles[lane])[0].data()[i]); });
    return corners;
  } else {
    Lanes<double, 8> column[W / 8][9];
    for (int part = 0; part < W / 8; ++part) transpose_corners(triangles + 8 * part, column[part]);
    for (int i = 0; i < 9; ++i) {
      S& corner = corners[i / 3][i % 3];
      if constexpr (W == 8)
        corner = batch_from<S>(__builtin_convertvector(column[0][i], Lanes<T, 8>));
      else
        corner = batch_from<S>(joined<T, 8>(__builtin_convertvector(column[0][i], Lanes<T, 8>),
                                            __builtin_convertvector(column[1][i], Lanes<T, 8>)));
    }
    return corners;
  }
}

}  // namespace detail

}  // namespace bvlab
