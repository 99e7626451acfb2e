// SPDX-License-Identifier: BSD-3-Clause
/// Sine and cosine that come out the same, bit for bit, on every machine: only operations that
/// IEEE 754 defines to the last digit. The C library's differ between versions and processors, and
/// a scene must not.
#pragma once

#include <cmath>
#include <utility>

namespace bvlab {

/// (cos, sin) of an angle given in turns; exact at every quarter turn. Off by less
/// than 4e-16: the argument is reduced to an eighth of a turn either way, without rounding, and
/// there the first term left out is x^17/17! < 5e-17 for the sine and x^18/18! for the cosine.
inline std::pair<double, double> cosine_sine(double turns) {
  const double quarters = std::nearbyint(turns * 4);
  const double x = (turns - quarters / 4) * 6.283185307179586;
  const double xx = x * x;
  double cosine = 1, sine = 1;
  for (int k = 16; k >= 2; k -= 2) {
    cosine = 1 - xx / static_cast<double>(k * (k - 1)) * cosine;
    if (k < 16) sine = 1 - xx / static_cast<double>(k * (k + 1)) * sine;
  }
  sine *= x;
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return {cosine, sine};
    case 1:
      return {-sine, cosine};
    case 2:
      return {-cosine, -sine};
    default:
      return {sine, -cosine};
  }
}

}  // namespace bvlab
