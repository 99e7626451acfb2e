// SPDX-License-Identifier: BSD-3-Clause
/// A number as the unevaluated sum of two doubles: about 104 correct binary digits, unless
/// something over- or underflows (dekker1971floating). The relative error of an operation is at
/// most 2^-102 of the result for products and quotients, of the larger operand for sums.
#pragma once

#include <cmath>

namespace bvlab {

struct DoubleDouble {
  double high = 0, low = 0;  ///< |low| is at most half a unit in the last place of high

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double x) : high(x) {}
  constexpr DoubleDouble(double h, double l) : high(h), low(l) {}

  /// a + b, exactly.
  static DoubleDouble sum(double a, double b) {
    const double s = a + b, part = s - a;
    return {s, (a - (s - part)) + (b - part)};
  }
  /// a * b, exactly.
  static DoubleDouble product(double a, double b) {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
  }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble s = sum(a.high, b.high), t = sum(a.low, b.low);
    const DoubleDouble u = renormalised(s.high, s.low + t.high);
    return renormalised(u.high, u.low + t.low);
  }
  friend DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = product(a.high, b.high);
    return renormalised(p.high, p.low + (a.high * b.low + a.low * b.high));
  }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double q = a.high / b.high;
    const DoubleDouble rest = a - b * DoubleDouble(q);
    const double correction = rest.high / b.high;
    const DoubleDouble last = rest - b * DoubleDouble(correction);
    return DoubleDouble(q) + sum(correction, last.high / b.high);
  }
  friend bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high < b.high || (a.high == b.high && a.low < b.low);
  }
  friend bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
  explicit operator double() const { return high; }

 private:
  static DoubleDouble renormalised(double h, double l) {
    const double s = h + l;
    return {s, l - (s - h)};
  }
};

}  // namespace bvlab
