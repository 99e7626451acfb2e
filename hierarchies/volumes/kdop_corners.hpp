// SPDX-License-Identifier: BSD-3-Clause
/// K-DOPs posed by their vertices (klosowski1998efficient): the vertices are rotated and
/// bounded again, which is the optimum of a linear programme for which Realignment takes one
/// dual basis.
///
/// Vertices are enumerated once, when a volume is fitted (kdop_vertices.hpp). Posing rotates the
/// directions instead of the vertices, so that one vertex is projected on all of them in SIMD
/// lanes. Posing (C_u) takes 3 K/2 multiplications and 4 K/2 additions and comparisons for each
/// vertex, of which there are at most 2K - 4; a volume takes K + 3(2K - 4) + 2 numbers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/volumes/kdop.hpp"
#include "hierarchies/volumes/kdop_vertices.hpp"

namespace bvlab {

/// A pose prepared for vertices: n = R'd for each direction d, lane by lane, and offsets as in
/// Realignment: d.(t - o) plus all rounding errors. With |v| and every corner at most reach,
///   8u (reach + |t|) |d|     for the vertex in the world, see Placement
///   (1.01e + 16u) reach |d|  for n, rounded to T
///   3.1e reach |d|           for its product with a corner: three products, two sums
///   2.1e (reach + |t - o| + this) |d|  for the grain and the offset that are added
/// is less than 2 |d| slack, with `slack` that of Placement.
template <class T, int K>
struct RotatedDirections {
  static constexpr int lanes =
      std::min(native_width<T>, static_cast<int>(std::bit_ceil(unsigned{K / 2})));
  static constexpr int padded = (K / 2 + lanes - 1) / lanes * lanes;

  std::array<std::array<T, padded>, 3> normal{};  ///< component by component
  std::array<T, padded> offset{}, opposite_offset{};

  RotatedDirections() {
    for (int k = 0; k < K / 2; ++k)
      for (int i = 0; i < 3; ++i) normal[i][k] = Directions::direction(k)[i];
  }

  /// `error_bound`: an error of the pose itself, added to `slack`.
  RotatedDirections(const Pose& pose, const Vec3<double>& origin, double reach,
                    double error_bound = 0) {
    const KdopOffsets<T, K> offsets(pose, origin, reach, error_bound);
    for (int k = 0; k < K / 2; ++k) {
      const auto* d = Directions::direction(k);
      const Vec3<double> n = pose.rotation.transpose() * Vec3<double>(d[0], d[1], d[2]);
      for (int i = 0; i < 3; ++i) normal[i][k] = static_cast<T>(n[i]);
      offset[k] = offsets.along[k];
      opposite_offset[k] = offsets.opposite[k];
    }
  }

 private:
  using Directions = detail::KdopDirections<K>;
};

/// The policy that bounds a rotated K-DOP again by its vertices.
struct ByCorners {
  template <class T, int K>
  using placement = RotatedDirections<T, K>;
};

/// The hull of `corners`, widened by `grain` in every direction, is posed. It encloses all that the
/// bounds enclose, see KdopVertices.
template <Scalar S, int K>
struct Kdop<S, K, ByCorners> {
  static constexpr std::string_view name = K == 6    ? "aabb-corners"
                                           : K == 14 ? "kdop14-corners"
                                           : K == 18 ? "kdop18-corners"
                                                     : "kdop26-corners";
  static constexpr std::string_view description =
      "slabs along fixed directions, posed by the vertices they make (Klosowski et al. 1998)";
  using scalar = S;
  template <class Other>
  using over = Kdop<Other, K, ByCorners>;
  using placement = RotatedDirections<Element<S>, K>;
  static constexpr int room = detail::KdopVertices<K>::room;

  // Fitted for scalar S only; a batch of volumes has the same members over batches.
  std::array<S, K> bounds;
  std::array<std::array<S, 3>, room> corners;  ///< those beyond `count` repeat the first
  S count, grain;

  static Kdop enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    return around(Kdop<S, K>::enclosing(points).bounds);
  }

  static Kdop around(const std::array<S, K>& bounds)
    requires(!Batched<S>)
  {
    constexpr double e = unit_roundoff<S>;
    std::array<double, K> wide;
    double scale = 0;
    for (int m = 0; m < K; ++m) {
      wide[m] = static_cast<double>(bounds[m]);
      scale = std::max(scale, std::abs(wide[m]));
    }
    // Rounding the bounds to S splits a vertex of many planes into several, at most this far
    // apart.
    const detail::KdopVertices<K> vertices(wide, scale, 4 * e * scale);
    Kdop result;
    result.bounds = bounds;
    result.count = static_cast<S>(vertices.count);
    // A corner is off by `error` plus its rounding, in each component; times 3 |R'd| / |d| along
    // any direction. The rest covers sums of three components and the rounding here.
    result.grain = rounded_up<S>(3.1 * (vertices.error + e * scale) + 8 * e * scale +
                                 8 * static_cast<double>(std::numeric_limits<S>::min()));
    for (int i = 0; i < room; ++i) {
      const Vec3<S> corner = rounded<S>(vertices.at[i < vertices.count ? i : 0]);
      result.corners[i] = {corner[0], corner[1], corner[2]};
    }
    return result;
  }
};

template <class S, int K>
Kdop<S, K, ByCorners> merge(const Kdop<S, K, ByCorners>& a, const Kdop<S, K, ByCorners>& b) {
  return Kdop<S, K, ByCorners>::around(merge(Kdop<S, K>{a.bounds}, Kdop<S, K>{b.bounds}).bounds);
}

/// Posed (one N_u), computed in batches of directions.
template <class S, int K>
  requires(!Batched<S>)
Kdop<S, K> posed(const Kdop<S, K, ByCorners>& volume, const RotatedDirections<S, K>& pose) {
  using Rotated = RotatedDirections<S, K>;
  using B = Batch<S, Rotated::lanes>;
  constexpr auto anywhere = stdx::element_aligned;
  std::array<S, Rotated::padded> above, below;
  const int count = static_cast<int>(volume.count);
  for (int k = 0; k < K / 2; k += Rotated::lanes) {
    const B x(&pose.normal[0][k], anywhere), y(&pose.normal[1][k], anywhere),
        z(&pose.normal[2][k], anywhere);
    const auto along = [&](int i) {
      const auto& corner = volume.corners[i];
      return (x * B(corner[0]) + y * B(corner[1])) + z * B(corner[2]);
    };
    B most = along(0), least = most;
    for (int i = 1; i < count; ++i) {
      const B at = along(i);
      most = stdx::max(most, at), least = stdx::min(least, at);
    }
    const B grain(volume.grain);
    ((most + grain) + B(&pose.offset[k], anywhere)).copy_to(&above[k], anywhere);
    ((grain - least) + B(&pose.opposite_offset[k], anywhere)).copy_to(&below[k], anywhere);
  }
  Kdop<S, K> result;
  for (int k = 0; k < K / 2; ++k)
    result.bounds[2 * k] = above[k], result.bounds[2 * k + 1] = below[k];
  return result;
}

/// The same for a batch of volumes, one per lane.
template <Batched S, int K>
Kdop<S, K> posed(const Kdop<S, K, ByCorners>& volume,
                 const RotatedDirections<Element<S>, K>& pose) {
  Kdop<S, K> result;
  const int count = static_cast<int>(stdx::hmax(volume.count));
  for (int k = 0; k < K / 2; ++k) {
    const auto along = [&](int i) {
      const auto& corner = volume.corners[i];
      return (S(pose.normal[0][k]) * corner[0] + S(pose.normal[1][k]) * corner[1]) +
             S(pose.normal[2][k]) * corner[2];
    };
    S most = along(0), least = most;
    for (int i = 1; i < count; ++i) {
      const S at = along(i);
      most = stdx::max(most, at), least = stdx::min(least, at);
    }
    result.bounds[2 * k] = (most + volume.grain) + S(pose.offset[k]);
    result.bounds[2 * k + 1] = (volume.grain - least) + S(pose.opposite_offset[k]);
  }
  return result;
}

}  // namespace bvlab
