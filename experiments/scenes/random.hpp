// SPDX-License-Identifier: BSD-3-Clause
/// A stream of random numbers that is the same on every machine: xoshiro256** seeded by splitmix64
/// (Blackman and Vigna, public domain), with distributions of our own, since those of the standard
/// library differ from one implementation to the next. Square roots are the only functions used.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

class Random {
 public:
  explicit Random(std::uint64_t seed) {
    for (auto& word : state_) {
      seed += 0x9e3779b97f4a7c15u;
      std::uint64_t z = seed;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      word = z ^ (z >> 31);
    }
  }

  std::uint64_t bits() {
    const std::uint64_t result = rotated(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotated(state_[3], 45);
    return result;
  }

  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// One of 0 ... n-1, n at least 1; every one as likely as the others.
  std::uint64_t below(std::uint64_t n) {
    const std::uint64_t uneven = (0 - n) % n;  // 2^64 mod n: this many outcomes are drawn again
    std::uint64_t drawn = bits();
    while (drawn < uneven) drawn = bits();
    return drawn % n;
  }
  bool happens(double probability) { return uniform() < probability; }

  /// A unit vector, uniform on the sphere: a point of the ball, pushed out.
  Vec3<double> direction() {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
      const double square = (x * x + y * y) + z * z;
      if (square > 1 || square < 1e-6) continue;
      const double length = std::sqrt(square);
      return {x / length, y / length, z / length};
    }
  }

  /// A unit quaternion (w, x, y, z), uniform over all rotations (Marsaglia's method).
  std::array<double, 4> rotation() {
    double a, b, ab, c, d, cd;
    do a = uniform(-1, 1), b = uniform(-1, 1), ab = a * a + b * b;
    while (ab >= 1);
    do c = uniform(-1, 1), d = uniform(-1, 1), cd = c * c + d * d;
    while (cd >= 1 || cd < 1e-12);
    const double factor = std::sqrt((1 - ab) / cd);
    return {a, b, c * factor, d * factor};
  }

 private:
  static std::uint64_t rotated(std::uint64_t x, int by) { return x << by | x >> (64 - by); }
  std::array<std::uint64_t, 4> state_;
};

}  // namespace bvlab
