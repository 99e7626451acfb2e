// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/predicates.hpp"

namespace bvlab {
namespace {

using Corners = std::span<const std::uint32_t>;

/// The two coordinates in which a polygon looks largest, in the order in which it runs to the left.
struct Projection {
  int u = 1, v = 2;
  bool is_flat = true;  ///< there is no area to be seen
};

Projection projection_of(const TriangleMesh& mesh, Corners corners) {
  double size = 0;
  for (const auto corner : corners)
    size = std::max(size, mesh.vertices[corner].cwiseAbs().maxCoeff());
  // By a power of two, so that squares neither over- nor underflow; about the first corner, so that
  // nothing is lost far from the origin.
  int exponent = 0;
  std::frexp(size, &exponent);
  const auto scaled = [&](std::uint32_t corner) {
    Vec3<double> at;
    for (int d = 0; d < 3; ++d) at[d] = std::ldexp(mesh.vertices[corner][d], -exponent);
    return at;
  };
  const Vec3<double> origin = scaled(corners[0]);
  Vec3<double> normal = Vec3<double>::Zero(), p = Vec3<double>::Zero();
  for (const auto corner : corners.subspan(1)) {
    const Vec3<double> q = scaled(corner) - origin;
    normal += p.cross(q);
    p = q;
  }
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (std::abs(normal[d]) > std::abs(normal[axis])) axis = d;
  Projection projection{(axis + 1) % 3, (axis + 2) % 3, normal[axis] == 0};
  if (normal[axis] < 0) std::swap(projection.u, projection.v);
  return projection;
}

/// What is left of a polygon, as a ring of the positions of its corners.
class Ring {
 public:
  Ring(const TriangleMesh& mesh, Corners corners, Projection projection)
      : mesh_(mesh), corners_(corners), projection_(projection) {
    const auto n = static_cast<std::uint32_t>(corners.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_.push_back((i + 1) % n);
      previous_.push_back((i + n - 1) % n);
    }
    for (std::uint32_t i = 0; i < n; ++i)
      if (turn(i) <= 0) concave_.push_back(i);
  }

  std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  std::uint32_t previous(std::uint32_t i) const { return previous_[i]; }

  /// 1 where the outline turns left at the corner, 0 where it goes on or back along one line.
  int turn(std::uint32_t i) const { return turn(previous_[i], i, next_[i]); }

  /// Whether what is cut off there is within the polygon, or nothing.
  bool is_ear(std::uint32_t i) const {
    const std::uint32_t before = previous_[i], after = next_[i];
    const int here = turn(i);
    if (here <= 0) return here == 0 && turns_back(i);
    return std::none_of(concave_.begin(), concave_.end(), [&](auto other) {
      return other != before && other != i && other != after && !removed(other) &&
             reaches_into(other, {before, i, after});
    });
  }

  void remove(std::uint32_t i) {
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    next_[i] = i;
    std::erase_if(concave_, [&](auto corner) { return removed(corner); });
    for (const auto corner : {previous_[i], next_of_removed(i)}) {
      const auto at = std::find(concave_.begin(), concave_.end(), corner);
      const bool concave = turn(corner) <= 0;
      if (concave && at == concave_.end()) concave_.push_back(corner);
      if (!concave && at != concave_.end()) concave_.erase(at);
    }
  }

  /// The corner, from `at` on, at which least is cut off.
  std::uint32_t flattest(std::uint32_t at) const {
    std::uint32_t best = at;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = at;;) {
      const double area = std::abs(area_of(previous_[i], i, next_[i]));
      if (area < least) best = i, least = area;
      if ((i = next_[i]) == at) return best;
    }
  }

 private:
  const Vec3<double>& at(std::uint32_t i) const { return mesh_.vertices[corners_[i]]; }
  double u(std::uint32_t i) const { return at(i)[projection_.u]; }
  double v(std::uint32_t i) const { return at(i)[projection_.v]; }
  bool is_same(std::uint32_t i, std::uint32_t j) const { return u(i) == u(j) && v(i) == v(j); }
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(at(a), at(b), at(c), projection_.u, projection_.v);
  }
  double area_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return (u(b) - u(a)) * (v(c) - v(a)) - (v(b) - v(a)) * (u(c) - u(a));
  }
  bool removed(std::uint32_t i) const { return next_[i] == i; }
  std::uint32_t next_of_removed(std::uint32_t i) const { return next_[previous_[i]]; }

  /// Of a corner without a turn: whether it repeats a neighbour or is the tip of a spike.
  bool turns_back(std::uint32_t i) const {
    const std::uint32_t a = previous_[i], b = next_[i];
    if (is_same(i, a) || is_same(i, b)) return true;
    const auto sides = [](double from, double x, double y) { return (x < from) == (y < from); };
    return u(i) != u(a) ? sides(u(i), u(a), u(b)) : sides(v(i), v(a), v(b));
  }

  /// Whether the outline enters the triangle at another corner. Where that one stands on one of the
  /// triangle's corners, the edges at it tell.
  bool reaches_into(std::uint32_t other, const std::array<std::uint32_t, 3>& triangle) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
      if (!is_same(other, a)) continue;
      const auto enters = [&](std::uint32_t to) {
        return turn(a, b, to) > 0 && turn(a, c, to) < 0;
      };
      return enters(next_[other]) || enters(previous_[other]);
    }
    const auto [a, b, c] = triangle;
    return turn(a, b, other) >= 0 && turn(b, c, other) >= 0 && turn(c, a, other) >= 0;
  }

  const TriangleMesh& mesh_;
  Corners corners_;
  Projection projection_;
  std::vector<std::uint32_t> next_, previous_, concave_;
};

/// Cuts ears; false if the outline crosses itself, so that some part is covered more than once.
bool cut_ears(TriangleMesh& mesh, Corners corners, Projection projection) {
  Ring ring(mesh, corners, projection);
  bool is_covered_once = true;
  int patience = 64;  // with outlines that have no ear; after that any cut will do
  std::uint32_t at = 1;
  for (std::size_t left = corners.size(); left > 2; --left) {
    std::size_t looked_at = 0;
    while (patience > 0 && looked_at < left && !ring.is_ear(at)) at = ring.next(at), ++looked_at;
    if (looked_at == left) at = ring.flattest(at), --patience;
    is_covered_once = is_covered_once && ring.turn(at) >= 0;
    mesh.triangles.push_back({corners[ring.previous(at)], corners[at], corners[ring.next(at)]});
    const std::uint32_t after = ring.next(at);
    ring.remove(at);
    at = after;
  }
  return is_covered_once;
}

/// The cut whose triangles have the least area in all, by dynamic programming (Klincsek 1980).
class LeastArea {
 public:
  LeastArea(TriangleMesh& mesh, Corners corners)
      : mesh_(mesh), corners_(corners), cost_(square(), 0), split_(square(), 0) {
    const std::size_t n = corners.size();
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t i = 0; i + length < n; ++i) find(i, i + length);
  }
  void append() { append(0, corners_.size() - 1); }

 private:
  std::size_t square() const { return corners_.size() * corners_.size(); }
  std::size_t place(std::size_t i, std::size_t j) const { return i * corners_.size() + j; }

  void find(std::size_t i, std::size_t j) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = i + 1;
    for (std::size_t k = i + 1; k < j; ++k) {
      const Vec3<double>& a = mesh_.vertices[corners_[i]];
      const Vec3<double> p = mesh_.vertices[corners_[k]] - a, q = mesh_.vertices[corners_[j]] - a;
      const double cost = cost_[place(i, k)] + cost_[place(k, j)] + p.cross(q).norm();
      if (cost < least) least = cost, best = k;
    }
    cost_[place(i, j)] = least;
    split_[place(i, j)] = best;
  }
  void append(std::size_t i, std::size_t j) {
    if (j < i + 2) return;
    const std::size_t k = split_[place(i, j)];
    append(i, k);
    mesh_.triangles.push_back({corners_[i], corners_[k], corners_[j]});
    append(k, j);
  }

  TriangleMesh& mesh_;
  Corners corners_;
  std::vector<double> cost_;
  std::vector<std::size_t> split_;
};

}  // namespace

void append_polygon(TriangleMesh& mesh, Corners corners) {
  constexpr std::size_t most_crossing = 64;
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    return;
  }
  const Projection projection = projection_of(mesh, corners);
  const std::size_t before = mesh.triangles.size();
  if (cut_ears(mesh, corners, projection) && !projection.is_flat) return;
  if (corners.size() > most_crossing) return;
  mesh.triangles.resize(before);
  LeastArea(mesh, corners).append();
}

void append_strip(TriangleMesh& mesh, Corners corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const std::size_t turned = i % 2;
    mesh.triangles.push_back({corners[i - 2 + turned], corners[i - 1 - turned], corners[i]});
  }
}

void append_fan(TriangleMesh& mesh, Corners corners) {
  for (std::size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

}  // namespace bvlab
