// SPDX-License-Identifier: BSD-3-Clause
/// Sets of triangle pairs, from harmless to nasty: what the tests of the triangle test and its
/// benchmark are made of. A set is a function of its size and seed.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

using TrianglePair = std::array<Triangle, 2>;

/// One pair after the other.
class TriangleSource {
 public:
  explicit TriangleSource(std::uint64_t seed) : random_(seed) {}

  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3<double> point() {
    const double x = uniform(), y = uniform(), z = uniform();
    return {x, y, z};
  }
  Vec3<double> grid_point() {
    const double x = integer(0, 4), y = integer(0, 4), z = integer(0, 4);
    return {x, y, z};
  }
  Mat3<double> rotation() {
    return Eigen::Quaterniond(uniform(), uniform(), uniform(), uniform())
        .normalized()
        .toRotationMatrix();
  }

  template <class F>
  static TrianglePair corners(const F& point) {
    TrianglePair pair;
    for (auto& t : pair)
      for (auto& p : t) p = point();
    return pair;
  }
  template <class F>
  static TrianglePair mapped(TrianglePair pair, const F& f) {
    for (auto& t : pair)
      for (auto& p : t) p = f(p);
    return pair;
  }

  TrianglePair random() {
    return corners([&] { return point(); });
  }
  TrianglePair grid() {
    return corners([&] { return grid_point(); });
  }
  TrianglePair coplanar() {
    const int flat = integer(0, 2);
    const double level = uniform();
    return corners([&] {
      Vec3<double> p = point();
      p[flat] = level;
      return p;
    });
  }
  /// Numbers from all over the range of doubles, made of a few powers of two from `least` to `most`
  /// so that sums and products of some meet others: zeros, single powers, sums of two of them with
  /// nothing between, and the same with all their digits.
  class AnyMagnitude {
   public:
    AnyMagnitude(TriangleSource& source, int least, int most) : source_(source) {
      for (int& exponent : exponents_) exponent = source.integer(least, most);
      // The ends of the range oftener than chance has it.
      if (source.integer(0, 2) == 0) exponents_[0] = least;
      if (source.integer(0, 2) == 0) exponents_[1] = most;
    }
    double operator()() {
      switch (source_.integer(0, 7)) {
        case 0:
        case 1:
          return 0;
        case 2:
          return some() + some();
        case 3:
          return some() * source_.uniform();
        default:
          return some();
      }
    }
    Vec3<double> point() {
      const double x = (*this)(), y = (*this)(), z = (*this)();
      return {x, y, z};
    }

   private:
    double some() { return std::ldexp(source_.integer(-3, 3), exponents_[source_.integer(0, 2)]); }
    TriangleSource& source_;
    int exponents_[3];
  };

  /// Corners of such numbers, finite up to most = 1020; sometimes
  /// all in a plane, or one of them an inner point of the other triangle, up to rounding.
  TrianglePair any_magnitude(int least = -1074, int most = 1020) {
    AnyMagnitude number(*this, least, most);
    TrianglePair pair = corners([&] { return number.point(); });
    if (integer(0, 3) == 0) {
      const int flat = integer(0, 2);
      const double level = number();
      pair = mapped(pair, [&](Vec3<double> p) {
        p[flat] = level;
        return p;
      });
    }
    if (integer(0, 3) == 0) {
      const auto& [a, b, c] = pair[0];
      pair[1][integer(0, 2)] = 0.5 * a + 0.25 * b + 0.25 * c;
    }
    return pair;
  }

  TrianglePair rotated(const TrianglePair& pair) {
    const Mat3<double> turn = rotation();
    return mapped(pair, [&](const auto& p) -> Vec3<double> { return turn * p; });
  }
  TrianglePair moved(const TrianglePair& pair, double distance) {
    const Vec3<double> by = distance * point();
    return mapped(pair, [&](const auto& p) -> Vec3<double> { return p + by; });
  }

  /// Two faces of a fan about one corner of a bumpy surface: they share an edge, a corner, or
  /// nothing but the neighbourhood.
  TrianglePair mesh_neighbours() {
    constexpr int valence = 6;
    const Mat3<double> turn = rotation();
    const auto on_surface = [&](double angle, double radius) -> Vec3<double> {
      return turn *
             Vec3<double>(radius * std::cos(angle), radius * std::sin(angle), 3 + 0.05 * uniform());
    };
    Vec3<double> ring[valence], outer[valence];
    const Vec3<double> centre = on_surface(0, 0);
    for (int i = 0; i < valence; ++i) {
      ring[i] = on_surface(i + 0.2 * uniform(), 1);
      outer[i] = on_surface(i + 0.5 + 0.2 * uniform(), 2);
    }
    const int i = integer(0, valence - 1), j = (i + integer(0, valence - 2)) % valence;
    const Triangle face = {centre, ring[i], ring[(i + 1) % valence]};
    if (i == j || integer(0, 1)) return {face, {ring[j], outer[j], ring[(j + 1) % valence]}};
    return {face, {centre, ring[j], ring[(j + 1) % valence]}};
  }

  /// A corner of the second on the first's surface, up to rounding: in a face, on an edge, on a
  /// corner.
  TrianglePair touching() { return touching_at(random()); }
  TrianglePair touching_at(TrianglePair pair) {
    double s = 0.5 + 0.5 * uniform(), t = (1 - s) * (0.5 + 0.5 * uniform());
    if (integer(0, 2) == 0) t = 0;
    if (integer(0, 4) == 0) s = 0;
    const auto& [a, b, c] = pair[0];
    pair[1][integer(0, 2)] = a + s * (b - a) + t * (c - a);
    return pair;
  }

  /// Needles that cross up to rounding, whose third corner is nearly or exactly on the line of the
  /// other two.
  TrianglePair slivers() {
    TrianglePair pair = random();
    const auto along = [](const Triangle& t, double s) -> Vec3<double> {
      return t[0] + s * (t[1] - t[0]);
    };
    pair[1][1] = 2 * along(pair[0], 0.5 + 0.6 * uniform()) - pair[1][0];
    for (auto& t : pair) {
      t[2] = along(t, uniform());
      if (integer(0, 1)) t[2] += std::ldexp(1, -integer(20, 50)) * point();
    }
    return pair;
  }

  /// Segments and points among triangles, on a grid so that they meet.
  TrianglePair without_area() {
    TrianglePair pair = grid();
    for (auto& t : pair) switch (integer(0, 3)) {
        case 0:
          t[2] = t[integer(0, 1)];
          break;
        case 1:
          t[1] = t[2] = t[0];
          break;
        case 2:
          t[2] = 2 * t[1] - t[0];
          break;
        default:
          break;
      }
    return pair;
  }

 private:
  std::mt19937_64 random_;
};

struct TriangleSet {
  std::string_view name;
  TrianglePair (*next)(TriangleSource&);

  std::vector<TrianglePair> make(std::size_t pairs, std::uint64_t seed) const {
    TriangleSource source(seed);
    std::vector<TrianglePair> result;
    result.reserve(pairs);
    while (result.size() < pairs) result.push_back(next(source));
    return result;
  }
};

inline constexpr TriangleSet triangle_sets[] = {
    {"random", [](TriangleSource& s) { return s.random(); }},
    {"integer grid", [](TriangleSource& s) { return s.grid(); }},
    {"integer grid, rotated", [](TriangleSource& s) { return s.rotated(s.grid()); }},
    {"coplanar", [](TriangleSource& s) { return s.coplanar(); }},
    {"coplanar, rotated", [](TriangleSource& s) { return s.rotated(s.coplanar()); }},
    {"mesh neighbours", [](TriangleSource& s) { return s.mesh_neighbours(); }},
    {"touching", [](TriangleSource& s) { return s.touching(); }},
    {"slivers", [](TriangleSource& s) { return s.slivers(); }},
    {"without area", [](TriangleSource& s) { return s.without_area(); }},
    {"without area, rotated", [](TriangleSource& s) { return s.rotated(s.without_area()); }},
    {"far from the origin", [](TriangleSource& s) { return s.moved(s.touching(), 1e6); }},
    {"far and touching", [](TriangleSource& s) { return s.touching_at(s.moved(s.random(), 1e6)); }},
};

}  // namespace bvlab
