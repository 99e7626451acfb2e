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
/// Samples are rounded up.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) used[v] = true;
    for (auto& coordinates : points_)
      coordinates.reserve(used.size() + stdx::native_simd<double>::size());
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v])
        for (int k = 0; k < 3; ++k) points_[k].push_back(mesh.vertices[v][k] - centre[k]);
    // The last register is filled up with copies of the last point.
    for (auto& coordinates : points_)
      while (coordinates.size() % stdx::native_simd<double>::size() != 0)
        coordinates.push_back(coordinates.back());
    for (std::size_t k = 0; k < points_[0].size(); ++k)
      farthest_ = std::max(
          farthest_, std::abs(points_[0][k]) + std::abs(points_[1][k]) + std::abs(points_[2][k]));
    samples_.resize(samples);
    threads.share(6 * row, [&](std::size_t part, std::size_t) {
      const int face = static_cast<int>(part) / row, i = static_cast<int>(part) % row;
      std::vector<double> along(points_[0].size());
      for (int j = 0; j < row; ++j)
        samples_[part * row + static_cast<std::size_t>(j)] =
            sample(on_face(face, 2.0 * i / cells - 1, 2.0 * j / cells - 1), along);
    });
    points_ = {};
  }

  /// The sample of direction (i, j) of face 2 axis + (negative ? 1 : 0) is at (face * row + i) *
  /// row + j. The coordinate `axis` of that direction is 1 or -1, the next one, modulo 3, is 2 i /
  /// cells - 1 and the one after that 2 j / cells - 1.
  const std::vector<SupportSample>& table() const { return samples_; }
  std::size_t bytes() const { return samples_.size() * sizeof(SupportSample); }

 private:
  static Vec3<double> on_face(int face, double u, double w) {
    const int axis = face / 2;
    Vec3<double> g;
    g[axis] = face % 2 ? -1 : 1;
    g[(axis + 1) % 3] = u, g[(axis + 2) % 3] = w;
    return g;
  }

  /// The sample in direction g; `far` is a buffer for the heights of all points. A difference and
  /// three products in float64 have fewer than 5 roundings.
  SupportSample sample(const Vec3<double>& g, std::vector<double>& far) const {
    const std::size_t count = far.size();
    const double *x = points_[0].data(), *y = points_[1].data(), *z = points_[2].data();
    using Several = stdx::native_simd<double>;
    Several most(-std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < count; k += Several::size()) {
      const auto from = [k](const double* p) { return Several(p + k, stdx::element_aligned); };
      const Several along = (from(x) * g[0] + from(y) * g[1]) + from(z) * g[2];
      along.copy_to(&far[k], stdx::element_aligned);
      most = stdx::max(most, along);
    }
    const auto at = static_cast<std::size_t>(std::find(far.begin(), far.end(), stdx::hmax(most)) -
                                             far.begin()) %
                    count;
    SupportSample found;
    for (int k = 0; k < 3; ++k) found.point[k] = static_cast<float>(points_[k][at]);
    found.height = rounded_up<float>(far[at] + 8 * unit_roundoff<double> * farthest_);
    return found;
  }

  std::vector<SupportSample> samples_;
  double farthest_ = 0;
  std::array<LargeVector<double>, 3> points_;  // only during construction, coordinate by coordinate
};

}  // namespace bvlab
