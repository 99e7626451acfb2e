// SPDX-License-Identifier: BSD-3-Clause
/// Gathers the corners of W triangles from anywhere in memory into batches, one triangle a lane
/// (transpose.hpp): about 3 ns a triangle faster than one number at a time.
#pragma once

#include <cstddef>
#include <cstring>

#include "hierarchies/geometry/scalar.hpp"
#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/transpose.hpp"

namespace bvlab {

namespace detail {

/// The nine coordinates of 8 triangles, one batch for each coordinate.
[[gnu::always_inline]] inline void transpose_corners(const Triangle* const* triangles,
                                                     Lanes<double, 8>* column) {
  const auto row = [&](int k) { return (*triangles[k])[0].data(); };
  const auto low = columns_of<double, 8>(row),
             high = columns_of<double, 8>([&](int k) { return row(k) + 4; });
  for (std::size_t i = 0; i < 4; ++i) column[i] = low[i], column[4 + i] = high[i];
  // At once: written lane by lane it would be read back before the stores are done.
  column[8] = Lanes<double, 8>{row(0)[8], row(1)[8], row(2)[8], row(3)[8],
                               row(4)[8], row(5)[8], row(6)[8], row(7)[8]};
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
