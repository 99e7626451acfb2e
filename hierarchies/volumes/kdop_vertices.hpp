// SPDX-License-Identifier: BSD-3-Clause
/// Enumerates the vertices of a K-DOP from triples of its planes. O(K^3) when a volume is fitted;
/// most triples are rejected by the first planes that they are tested against.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/volumes/kdop_directions.hpp"

namespace bvlab::detail {

/// Points whose hull encloses { x : n_m.x <= bounds[m] } up to `error` in each component: every
/// vertex of that polytope is that near to one of them. None is outside the box along the axes.
///
/// Where three planes meet is a quotient of integer combinations of bounds by an integer, computed
/// to 18u scale in each component: |n_i x n_j| has components up to 2 and products with them are
/// exact, so that 12u scale is for sums, and with a determinant of at least 1 another 6u for the
/// quotient. Tested against a plane a true vertex is off by three times that and 6u scale for the
/// sum: it is never lost with a tolerance of 64u scale. Other points within the tolerance are near
/// the polytope, and do no harm.
///
/// A simple polytope with K faces has at most 2K - 4 vertices. Where more planes meet in a point,
/// it is found many times: points within `nearness` of one found before are dropped. If the points
/// still do not fit (flat volumes, accurate to a few digits only), or numbers are too large for
/// their sums, the corners of the box are taken, which enclose everything.
template <int K>
class KdopVertices {
 public:
  static constexpr int room = 2 * K - 4;

  std::array<Vec3<double>, room> at;
  int count = 0;
  double error = 0;

  /// `scale`: the largest magnitude of all bounds; `nearness`: points this near are one vertex.
  KdopVertices(const std::array<double, K>& bounds, double scale, double nearness)
      : bounds_(bounds) {
    constexpr double u = unit_roundoff<double>, tiny = std::numeric_limits<double>::min();
    tolerance_ = 64 * u * scale + tiny;
    nearness_ = std::max(nearness, 40 * u * scale);
    error = nearness_ + 18 * u * scale + tiny;
    if (!(scale < std::numeric_limits<double>::max() / 64) || !enumerate() || count == 0) box();
  }

 private:
  using Directions = KdopDirections<K>;
  using Integers = std::array<int, 3>;

  static constexpr std::array<Integers, K> normals = [] {
    std::array<Integers, K> all{};
    for (int m = 0; m < K; ++m)
      for (int i = 0; i < 3; ++i) all[m][i] = Directions::component(m, i);
    return all;
  }();

  static constexpr Integers cross(const Integers& a, const Integers& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }

  /// Returns false if there are more vertices than room.
  bool enumerate() {
    for (int i = 0; i < K; ++i)
      for (int j = i + 1; j < K; ++j) {
        const Integers ij = cross(normals[i], normals[j]);
        if (ij == Integers{}) continue;
        for (int k = j + 1; k < K; ++k) {
          const auto& n = normals[k];
          const int determinant = ij[0] * n[0] + ij[1] * n[1] + ij[2] * n[2];
          if (determinant == 0) continue;
          const Integers jk = cross(normals[j], n), ki = cross(n, normals[i]);
          Vec3<double> x;
          for (int c = 0; c < 3; ++c)
            x[c] = (bounds_[k] * ij[c] + bounds_[i] * jk[c] + bounds_[j] * ki[c]) / determinant;
          if (inside(x) && !add(x)) return false;
        }
      }
    return true;
  }

  bool inside(const Vec3<double>& x) const {
    for (int m = 0; m < K; ++m) {
      const auto& n = normals[m];
      if (!((n[0] * x[0] + n[1] * x[1]) + n[2] * x[2] <= bounds_[m] + tolerance_)) return false;
    }
    return true;
  }

  /// Adds a point, first clamped to the box: the true vertex is in the box, so clamping moves no
  /// point farther from it.
  bool add(Vec3<double> x) {
    for (int c = 0; c < 3; ++c)
      x[c] = std::max(-bounds_[2 * c + 1], std::min(bounds_[2 * c], x[c]));
    for (int i = 0; i < count; ++i)
      if ((at[i] - x).template lpNorm<Eigen::Infinity>() <= nearness_) return true;
    if (count == room) return false;
    at[count++] = x;
    return true;
  }

  void box() {
    count = 8;
    for (int i = 0; i < 8; ++i)
      for (int c = 0; c < 3; ++c) at[i][c] = i >> c & 1 ? bounds_[2 * c] : -bounds_[2 * c + 1];
  }

  const std::array<double, K>& bounds_;
  double tolerance_, nearness_;
};

}  // namespace bvlab::detail
