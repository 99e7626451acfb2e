// SPDX-License-Identifier: BSD-3-Clause
/// A few functions of vectors and matrices, written without Eigen's expressions: nearly every unit
/// compiles them, and as expressions they take longer to compile than all other inline functions
/// together. No operation is contracted, so that results agree on every processor.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

/// The Euclidean norm, without over- or underflow of intermediate results.
inline double stable_norm(const Vec3<double>& v) {
  const double x = std::abs(v[0]), y = std::abs(v[1]), z = std::abs(v[2]);
  if (std::isnan(x) || std::isnan(y) || std::isnan(z))
    return std::numeric_limits<double>::quiet_NaN();
  const double largest = std::max({x, y, z});
  if (!(largest > 0)) return 0;
  double scale = largest, inverse = 1 / largest;
  if (largest > std::numeric_limits<double>::max()) {
    inverse = 1;
  } else if (inverse > std::numeric_limits<double>::max()) {
    inverse = std::numeric_limits<double>::max();
    scale = 1 / inverse;
  }
  const double a = v[0] * inverse, b = v[1] * inverse, c = v[2] * inverse;
  return scale * std::sqrt((a * a + b * b) + c * c);
}

/// The largest norm of some vectors, given the largest squared norm. Only if that may have over- or
/// underflowed, each(take) is called, which must call take(v) for every vector.
template <class Each>
double largest_norm(double largest_squared, const Each& each) {
  if (largest_squared > 1e-280 && largest_squared < 1e300) return std::sqrt(largest_squared);
  double largest = 0;
  each([&](const Vec3<double>& v) { largest = std::max(largest, stable_norm(v)); });
  return largest;
}

/// |M'M - I|_F: how far a matrix is from being orthonormal.
inline double defect_of(const Mat3<double>& m) {
  double squares[9];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const double product = (m(0, i) * m(0, j) + m(1, i) * m(1, j)) + m(2, i) * m(2, j);
      const double off = product - (i == j ? 1 : 0);
      squares[3 * j + i] = off * off;
    }
  const auto& s = squares;
  return std::sqrt(((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + (s[7] + s[8]))));
}

/// M (3/2 - M'M / 2): a step of Newton's iteration to the nearest orthonormal matrix, which squares
/// the defect.
inline Mat3<double> towards_orthonormal(const Mat3<double>& m) {
  Mat3<double> half, result;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      half(i, j) =
          (i == j ? 1.5 : 0) - 0.5 * ((m(0, i) * m(0, j) + m(1, i) * m(1, j)) + m(2, i) * m(2, j));
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      result(i, j) = (m(i, 0) * half(0, j) + m(i, 1) * half(1, j)) + m(i, 2) * half(2, j);
  return result;
}

}  // namespace bvlab
