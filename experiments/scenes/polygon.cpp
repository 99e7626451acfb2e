// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/polygon.hpp"

#include <array>
#include <cmath>

namespace bvlab {
namespace {

using Flat = std::array<double, 2>;

/// Positive if a, b, c turn left.
double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The corners without the coordinate along which the polygon looks largest, seen so that it runs
/// to the left.
std::vector<Flat> flattened(const TriangleMesh& mesh, std::span<const std::uint32_t> corners) {
  Vec3<double> normal = Vec3<double>::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& p = mesh.vertices[corners[i]];
    const auto& q = mesh.vertices[corners[(i + 1) % corners.size()]];
    for (int d = 0; d < 3; ++d) {
      const int u = (d + 1) % 3, v = (d + 2) % 3;
      normal[d] += (p[u] - q[u]) * (p[v] + q[v]);
    }
  }
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (std::abs(normal[d]) > std::abs(normal[axis])) axis = d;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<Flat> flat;
  flat.reserve(corners.size());
  for (const auto corner : corners)
    flat.push_back({mesh.vertices[corner][u], mesh.vertices[corner][v]});
  return flat;
}

/// What is left of a polygon, as a ring of the positions of its corners.
class Ring {
 public:
  explicit Ring(std::vector<Flat> flat) : flat_(std::move(flat)) {
    const auto n = static_cast<std::uint32_t>(flat_.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_.push_back((i + 1) % n);
      previous_.push_back((i + n - 1) % n);
    }
    for (std::uint32_t i = 0; i < n; ++i)
      if (!left(i)) concave_.push_back(i);
  }

  std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  std::uint32_t previous(std::uint32_t i) const { return previous_[i]; }

  bool is_ear(std::uint32_t i) const {
    if (!left(i)) return false;
    const std::uint32_t before = previous_[i], after = next_[i];
    for (const auto other : concave_)
      if (other != before && other != after && !removed(other) && holds(before, i, after, other))
        return false;
    return true;
  }

  void remove(std::uint32_t i) {
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    next_[i] = i;
    // Corners only ever become convex.
    std::erase_if(concave_, [&](auto corner) { return removed(corner) || left(corner); });
  }

 private:
  bool removed(std::uint32_t i) const { return next_[i] == i; }
  bool left(std::uint32_t i) const {
    return turn(flat_[previous_[i]], flat_[i], flat_[next_[i]]) > 0;
  }
  bool holds(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t p) const {
    const Flat& point = flat_[p];
    if (point == flat_[a] || point == flat_[b] || point == flat_[c]) return false;
    return turn(flat_[a], flat_[b], point) >= 0 && turn(flat_[b], flat_[c], point) >= 0 &&
           turn(flat_[c], flat_[a], point) >= 0;
  }

  std::vector<Flat> flat_;
  std::vector<std::uint32_t> next_, previous_, concave_;
};

}  // namespace

void append_polygon(TriangleMesh& mesh, std::span<const std::uint32_t> corners) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    return;
  }
  Ring ring(flattened(mesh, corners));
  std::uint32_t at = 1;
  // Without an ear the polygon crosses itself, and any cut is as good as another.
  bool has_ears = true;
  for (std::size_t left = corners.size(); left > 3; --left) {
    std::size_t looked_at = 0;
    while (has_ears && looked_at < left && !ring.is_ear(at)) at = ring.next(at), ++looked_at;
    has_ears = has_ears && looked_at < left;
    mesh.triangles.push_back({corners[ring.previous(at)], corners[at], corners[ring.next(at)]});
    const std::uint32_t after = ring.next(at);
    ring.remove(at);
    at = after;
  }
  mesh.triangles.push_back({corners[ring.previous(at)], corners[at], corners[ring.next(at)]});
}

}  // namespace bvlab
