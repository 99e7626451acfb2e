// SPDX-License-Identifier: BSD-3-Clause
/// Finds directions that separate two bodies, for many pairs at once, one per lane, by the bodies'
/// support maps: no volume is posed. The first direction is that between their centres; each
/// further one is mirrored at the plane normal to the vector between supports (chung1996quick).
///
/// Of pairs of bunnies with overlapping spheres and disjoint convex hulls, the first direction
/// separates four in five and the first two 19 in 20; of those with overlapping spheres that do not
/// touch, four in five or more have disjoint hulls.
///
/// Derivation. A vertex of a lies within 2 error_a (`error_bound` of OrthonormalPose) of c_a + R_a
/// v, v from the centre in the mesh, whatever matrix R_a is. For any d, with the support functions
/// h,
///
///   d.(x_b - x_a) >= d.(c_b - c_a) - h_a(R_a'd) - h_b(-R_b'd) - 2 |d| (error_a + error_b).
///
/// Let e be the unit roundoff of float, r a radius; to first order:
/// - centres are kept in float from a common origin, each off by e |c|_1; their difference, and its
///   product with d, by 4e |d||c_b - c_a|;
/// - R'd, whose entries are rounded and which is at most 1.1 |d| long, is off by 8e |d|, and h of
///   it by 9e |d| r;
/// - the position of g = R'd in its cell is off by 4e of the face's width, and a fraction of the
///   cell is exact: h of a direction within 12e |g| of g is interpolated, which is off by 14e |d|
///   r; weights and their sum by 8e of samples that are at most sqrt(3) r, times |g|: 16e |d| r;
/// - the sum by 3e of its terms.
/// So `slack`, which is 2 error_bound + 64e r + 2e |c|_1, of both, and 8e |c_b - c_a| exceed all of
/// it for |d| <= 1 + 8e; a number whose square is normal is added, which covers underflow.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/support_map.hpp"
#include "traversal/wide/gather_lanes.hpp"

namespace bvlab {

class SeparatingDirections {
 public:
  static constexpr int width = std::clamp(native_width<float>, 4, 16);
  using S = Batch<float, width>;
  using Indices = Batch<std::int32_t, width>;

  /// Adds a mesh; returns the number by which bodies name it.
  std::int32_t add(const SupportMap& map) {
    const auto first = static_cast<std::int32_t>(samples_.size());
    samples_.insert(samples_.end(), map.table().begin(), map.table().end());
    return first;
  }
  void set_map(std::size_t body, std::int32_t map) { bodies_[body].map = map; }
  void resize(std::size_t bodies) { bodies_.resize(bodies); }

  /// `centre` of the sphere that the map is about, from the common origin; `radius` of that sphere;
  /// `error_bound` as in OrthonormalPose.
  void set_pose(std::size_t body, std::int32_t map, const Mat3<double>& rotation,
                const Vec3<double>& centre, double radius, double error_bound) {
    constexpr double e = unit_roundoff<float>;
    Body& to = bodies_[body];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) to.rotation[3 * i + j] = static_cast<float>(rotation(i, j));
      to.centre[i] = static_cast<float>(centre[i]);
    }
    const double tiny = std::ldexp(1.0, std::numeric_limits<float>::min_exponent / 2 + 4);
    const double slack =
        (2 * error_bound + 2 * e * centre.lpNorm<1>() + 64 * e * radius + tiny) * (1 + 4 * e);
    to.slack = static_cast<float>(slack);
    to.reach = static_cast<float>((radius + slack) * (1 + 4 * e));
    to.map = map;
  }

  /// Pairs of bodies, one a lane.
  struct Pairs {
    Indices a, b;  ///< 16 times their indices
    Vec3<S> between;
    S slack;
  };
  [[gnu::always_inline]] Pairs pairs(const Indices& a, const Indices& b) const {
    Pairs p{a * 16, b * 16, {}, {}};
    for (int i = 0; i < 3; ++i)
      p.between[i] = of<&Body::centre>(p.b, i) - of<&Body::centre>(p.a, i);
    return p;
  }
  /// Which spheres may overlap.
  [[gnu::always_inline]] std::uint64_t spheres_meet(const Pairs& p) const {
    const S reach = of<&Body::reach>(p.a) + of<&Body::reach>(p.b);
    return ~bits(squared_norm<S>(p.between) * S(1 - 16 * unit_roundoff<float>) > reach * reach);
  }

  /// A lower bound on the distance of each pair, 0 where no direction separates it. Up to `most`
  /// directions are tried, starting with `first`.
  [[gnu::always_inline]] S gaps(const Pairs& p, const Vec3<S>& first, int most) const {
    constexpr float e = unit_roundoff<float>;
    const auto rotation_a = rotation(p.a), rotation_b = rotation(p.b);
    const Indices map_a = map(p.a), map_b = map(p.b);
    const S margin = ((of<&Body::slack>(p.a) + of<&Body::slack>(p.b)) +
                      S(8 * e) * stdx::sqrt(squared_norm<S>(p.between))) *
                     S(1 + 16 * e);
    S found(0.0f);
    Vec3<S> next = first;
    for (int tried = 1;; ++tried) {
      const Vec3<S> minus(-next[0], -next[1], -next[2]);
      const Support a = support(map_a, rotated_back(rotation_a, next));
      const Support b = support(map_b, rotated_back(rotation_b, minus));
      const S gap = ((dot<S>(next, p.between) - a.height) - b.height) - margin;
      stdx::where(gap > found, found) = gap * S(1 - 16 * e);
      if (tried == most || stdx::all_of(found > S(0.0f))) return found;
      Vec3<S> w = p.between;
      const Vec3<S> to_b = rotated(rotation_b, b.point), to_a = rotated(rotation_a, a.point);
      for (int i = 0; i < 3; ++i) w[i] = (w[i] + to_b[i]) - to_a[i];
      const S twice = S(2.0f) * dot<S>(next, w) / dot<S>(w, w);
      for (int i = 0; i < 3; ++i) next[i] = next[i] - twice * w[i];
      next = normalized(next);
    }
  }
  static Vec3<S> normalized(const Vec3<S>& v) {
    const S scale = S(1.0f) / stdx::sqrt(squared_norm<S>(v));
    return {v[0] * scale, v[1] * scale, v[2] * scale};
  }

 private:
  struct alignas(64) Body {
    float rotation[9] = {};  // row by row
    float centre[3] = {};
    // A body without a pose is never found apart from another.
    float slack = std::numeric_limits<float>::infinity();
    float reach = std::numeric_limits<float>::infinity();
    std::int32_t map = 0;
    float unused = 0;
  };
  static_assert(sizeof(Body) == 64);

  struct Support {
    Vec3<S> point;
    S height;
  };
  using Rotation = std::array<S, 9>;

  template <auto member>
  [[gnu::always_inline]] S of(const Indices& body, int i = 0) const {
    const auto& field = bodies_[0].*member;
    if constexpr (std::is_array_v<std::remove_reference_t<decltype(field)>>)
      return gathered<width>(&field[i], body);
    else
      return gathered<width>(&field, body);
  }
  [[gnu::always_inline]] Rotation rotation(const Indices& body) const {
    Rotation r;
    for (int i = 0; i < 9; ++i) r[static_cast<std::size_t>(i)] = of<&Body::rotation>(body, i);
    return r;
  }
  [[gnu::always_inline]] Indices map(const Indices& body) const {
    return std::bit_cast<Indices>(
        gathered<width>(reinterpret_cast<const float*>(&bodies_[0].map), body));
  }

  [[gnu::always_inline]] static Vec3<S> rotated(const Rotation& r, const Vec3<S>& v) {
    const auto along = [&](std::size_t i) {
      return fused<S>(r[i + 2], v[2], fused<S>(r[i + 1], v[1], r[i] * v[0]));
    };
    return {along(0), along(3), along(6)};
  }
  [[gnu::always_inline]] static Vec3<S> rotated_back(const Rotation& r, const Vec3<S>& v) {
    const auto along = [&](std::size_t i) {
      return fused<S>(r[i + 6], v[2], fused<S>(r[i + 3], v[1], r[i] * v[0]));
    };
    return {along(0), along(1), along(2)};
  }

  /// The interpolated height, and the support point of the nearest sample.
  [[gnu::always_inline]] Support support(const Indices& map, const Vec3<S>& g) const {
    using stdx::abs, stdx::max, stdx::min;
    constexpr int row = SupportMap::row;
    constexpr float half = SupportMap::cells / 2;
    const S x = abs(g[0]), y = abs(g[1]), z = abs(g[2]), longest = max(max(x, y), z);
    const auto by_y = y == longest, by_z = z == longest;
    S along = g[0], u = g[1], v = g[2], face(0.0f);
    stdx::where(by_y, along) = g[1], stdx::where(by_y, u) = g[2], stdx::where(by_y, v) = g[0];
    stdx::where(by_z, along) = g[2], stdx::where(by_z, u) = g[0], stdx::where(by_z, v) = g[1];
    stdx::where(by_y, face) = S(2.0f), stdx::where(by_z, face) = S(4.0f);
    stdx::where(along < S(0.0f), face) = face + S(1.0f);
    const S scale = S(half) / longest;
    const auto position = [&](const S& at) __attribute__((always_inline)) {
      return min(S(2 * half), max(S(0.0f), fused<S>(at, scale, S(half))));
    };
    // NaN becomes 0, so that the table index is valid.
    const S s = finite(position(u)), t = finite(position(v));
    const S i = cell_of(s), j = cell_of(t), p = s - i, q = t - j;
    const auto sample = [&](const S& first, const S& second) __attribute__((always_inline)) {
      return (map + stdx::static_simd_cast<Indices>((face * row + first) * row + second)) * 4;
    };
    const Indices at = sample(i, j);
    const auto height = [&](int offset) __attribute__((always_inline)) {
      return gathered<width>(&samples_[0].height + 4 * offset, at);
    };
    const S low = fused<S>(height(1) - height(0), q, height(0));
    const S high = fused<S>(height(row + 1) - height(row), q, height(row));
    const Indices nearest = sample(whole(s + S(0.5f)), whole(t + S(0.5f)));
    Support found;
    for (int k = 0; k < 3; ++k) found.point[k] = gathered<width>(&samples_[0].point[k], nearest);
    found.height = fused<S>(high - low, p, low) * longest;
    return found;
  }
  [[gnu::always_inline]] static S finite(S x) {
    stdx::where(!(x >= S(0.0f)), x) = S(0.0f);
    return x;
  }
  [[gnu::always_inline]] static S whole(const S& x) {
    return stdx::static_simd_cast<S>(stdx::static_simd_cast<Indices>(x));
  }
  [[gnu::always_inline]] static S cell_of(const S& at) {
    return stdx::min(whole(at), S(static_cast<float>(SupportMap::cells - 1)));
  }

  std::vector<Body> bodies_;
  std::vector<SupportSample> samples_;
};

}  // namespace bvlab
