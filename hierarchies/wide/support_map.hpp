// SPDX-License-Identifier: BSD-3-Clause
/// The extent of a mesh in any direction, in a few nanoseconds: its support function
///
///   h(g) = max over vertices v of g.(v - c),   c the centre of its sphere,
///
/// sampled over a cube of directions. h is convex and h(s g) = s h(g) for s > 0, so interpolation
/// between samples never falls below it: if g is a sum of directions g_i with weights w_i >= 0,
/// then h(g) <= sum w_i h(g_i), and bilinear weights on a face of the cube are such. The excess is
/// less than 1 % of the sphere's radius for 8 cells along an edge.
///
/// Samples are rounded up. The highest point is searched block by block: blocks of 64 vertices
/// whose boxes are lower than a point already found are skipped, nearly all where neighbours in a
/// mesh have numbers close to each other.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The farthest point of the mesh along a direction, relative to c, and its height along that
/// direction, rounded up.
struct alignas(16) SupportSample {
  float point[3], height;
};

class SupportMap {
 public:
  static constexpr int cells = 8;  ///< along an edge of the cube
  static constexpr int row = cells + 1, samples = 6 * row * row;

  SupportMap() = default;
  SupportMap(const TriangleMesh& mesh, const Vec3<double>& centre, Threads&& threads = Threads())
      : SupportMap(mesh, centre, threads) {}
  SupportMap(const TriangleMesh& mesh, const Vec3<double>& centre, Threads& threads) {
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) used[v] = 1;
    for (auto& coordinates : points_) coordinates.reserve(used.size() + block);
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v])
        for (int k = 0; k < 3; ++k) points_[k].push_back(mesh.vertices[v][k] - centre[k]);
    // The last block is filled up with copies of the last point.
    for (auto& coordinates : points_)
      coordinates.resize((coordinates.size() + block - 1) / block * block, coordinates.back());
    for (std::size_t k = 0; k < points_[0].size(); ++k)
      farthest_ = std::max(
          farthest_, std::abs(points_[0][k]) + std::abs(points_[1][k]) + std::abs(points_[2][k]));
    enclose_blocks();
    samples_.resize(samples);
    threads.share(6 * row, [&](std::size_t part, std::size_t) {
      const int face = static_cast<int>(part) / row, i = static_cast<int>(part) % row;
      std::vector<double> bounds(low_[0].size());
      for (int j = 0; j < row; ++j)
        samples_[part * row + static_cast<std::size_t>(j)] =
            sample(on_face(face, 2.0 * i / cells - 1, 2.0 * j / cells - 1), bounds);
    });
    points_ = {}, low_ = {}, high_ = {};
  }

  /// The sample of direction (i, j) of face 2 axis + (negative ? 1 : 0) is at (face * row + i) *
  /// row + j. The coordinate `axis` of that direction is 1 or -1, the next one, modulo 3, is 2 i /
  /// cells - 1 and the one after that 2 j / cells - 1.
  const std::vector<SupportSample>& table() const { return samples_; }

 private:
  static Vec3<double> on_face(int face, double u, double w) {
    const int axis = face / 2;
    Vec3<double> g;
    g[axis] = face % 2 ? -1 : 1;
    g[(axis + 1) % 3] = u, g[(axis + 2) % 3] = w;
    return g;
  }

  using Several = stdx::native_simd<double>;
  /// Points in a block, of which each has a box.
  static constexpr std::size_t block = 64;
  using Coordinates = std::array<LargeVector<double>, 3>;
  static_assert(block % Several::size() == 0);

  void enclose_blocks() {
    const std::size_t blocks = points_[0].size() / block;
    // Filled up to whole registers with boxes that no bound reaches.
    const std::size_t padded = (blocks + Several::size() - 1) / Several::size() * Several::size();
    for (int k = 0; k < 3; ++k) {
      low_[k].resize(padded, -std::numeric_limits<double>::max());
      high_[k].resize(padded, -std::numeric_limits<double>::max());
      for (std::size_t b = 0; b < blocks; ++b) {
        const auto [low, high] =
            std::minmax_element(points_[k].begin() + static_cast<std::ptrdiff_t>(b * block),
                                points_[k].begin() + static_cast<std::ptrdiff_t>((b + 1) * block));
        low_[k][b] = *low, high_[k][b] = *high;
      }
    }
  }

  /// Heights of several points or corners of boxes along g. Rounding is monotone, so the height of
  /// a box's farthest corner, as computed, is not below that of any point in the box.
  static Several along(const Vec3<double>& g, const std::array<const double*, 3>& from,
                       std::size_t k) {
    const auto at = [k](const double* p) { return Several(p + k, stdx::element_aligned); };
    return (at(from[0]) * g[0] + at(from[1]) * g[1]) + at(from[2]) * g[2];
  }
  std::array<const double*, 3> first_points() const {
    return {points_[0].data(), points_[1].data(), points_[2].data()};
  }
  double highest(const Vec3<double>& g, std::size_t b) const {
    const auto from = first_points();
    Several most(-std::numeric_limits<double>::infinity());
    for (std::size_t k = b * block; k < (b + 1) * block; k += Several::size())
      most = stdx::max(most, along(g, from, k));
    return stdx::hmax(most);
  }

  /// The sample in direction g; `bounds` is a buffer for the heights of all blocks' boxes. A
  /// difference and three products in float64 have fewer than 5 roundings.
  SupportSample sample(const Vec3<double>& g, std::vector<double>& bounds) const {
    std::array<const double*, 3> from;
    for (int k = 0; k < 3; ++k) from[k] = g[k] < 0 ? low_[k].data() : high_[k].data();
    for (std::size_t b = 0; b < bounds.size(); b += Several::size())
      along(g, from, b).copy_to(&bounds[b], stdx::element_aligned);
    const std::size_t blocks = points_[0].size() / block;
    const auto end = bounds.begin() + static_cast<std::ptrdiff_t>(blocks);
    auto best = static_cast<std::size_t>(std::max_element(bounds.begin(), end) - bounds.begin());
    // The block with the highest bound is searched first, then those whose bound is not lower.
    double most = highest(g, best);
    for (std::size_t b = 0; b < blocks; ++b)
      if (bounds[b] > most || (bounds[b] == most && b < best))
        if (const double height = highest(g, b); height > most || (height == most && b < best))
          most = height, best = b;
    return first_at(g, most, best);
  }
  /// The first point of block b with height `most`.
  SupportSample first_at(const Vec3<double>& g, double most, std::size_t b) const {
    const auto from = first_points();
    // The last one where there is no such point, as with NaN.
    std::size_t at = (b + 1) * block - 1;
    for (std::size_t k = b * block; k < (b + 1) * block; k += Several::size())
      if (const std::uint64_t found = bits(along(g, from, k) == most); found != 0) {
        at = k + static_cast<std::size_t>(std::countr_zero(found));
        break;
      }
    const double height = (points_[0][at] * g[0] + points_[1][at] * g[1]) + points_[2][at] * g[2];
    SupportSample found;
    for (int k = 0; k < 3; ++k) found.point[k] = static_cast<float>(points_[k][at]);
    found.height = rounded_up<float>(height + 8 * unit_roundoff<double> * farthest_);
    return found;
  }

  std::vector<SupportSample> samples_;
  double farthest_ = 0;
  // Only during construction: points and boxes of blocks, coordinate by coordinate.
  Coordinates points_, low_, high_;
};

}  // namespace bvlab
