// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/formula_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/circle.hpp"

namespace bvlab {
namespace {

using Point = Vec3<double>;
using Index = std::uint32_t;

// Sums in a fixed order, unlike a vectorised norm.
double length(const Point& p) { return std::sqrt((p[0] * p[0] + p[1] * p[1]) + p[2] * p[2]); }
Point unit(const Point& p) {
  const double l = length(p);
  return {p[0] / l, p[1] / l, p[2] / l};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::size_t difference(std::size_t a, std::size_t b) { return a > b ? a - b : b - a; }

/// The n >= 1 for which factor * n^2 is nearest to `polygons`.
std::size_t nearest_square(std::size_t polygons, std::size_t factor) {
  const auto root = static_cast<std::size_t>(
      std::sqrt(static_cast<double>(polygons) / static_cast<double>(factor)));
  std::size_t best = std::max<std::size_t>(root, 1);
  for (const std::size_t n : {best, best + 1})
    if (difference(factor * n * n, polygons) < difference(factor * best * best, polygons)) best = n;
  return best;
}

/// The icosahedron with every face cut into n^2 triangles, vertices pushed out to the unit sphere.
TriangleMesh geodesic_sphere(std::size_t n) {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  const std::array<Point, 12> corners = {Point{-1, golden, 0}, {1, golden, 0},   {-1, -golden, 0},
                                         {1, -golden, 0},      {0, -1, golden},  {0, 1, golden},
                                         {0, -1, -golden},     {0, 1, -golden},  {golden, 0, -1},
                                         {golden, 0, 1},       {-golden, 0, -1}, {-golden, 0, 1}};
  constexpr std::array<std::array<Index, 3>, 20> faces = {
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  TriangleMesh mesh;
  mesh.vertices.reserve(10 * n * n + 2);
  mesh.triangles.reserve(20 * n * n);
  for (const Point& corner : corners) mesh.vertices.push_back(unit(corner));

  // Weights are whole numbers, and what lies on an edge is made once, by the edge.
  const auto between = [&](Index a, Index b, std::size_t i) -> Point {
    const double s = static_cast<double>(n - i), t = static_cast<double>(i);
    return {s * corners[a][0] + t * corners[b][0], s * corners[a][1] + t * corners[b][1],
            s * corners[a][2] + t * corners[b][2]};
  };
  std::map<std::pair<Index, Index>, Index> first_on_edge;
  const auto on_edge = [&](Index a, Index b, std::size_t i) -> Index {
    if (i == 0) return a;
    if (i == n) return b;
    if (a > b) std::swap(a, b), i = n - i;
    const auto [place, fresh] =
        first_on_edge.try_emplace({a, b}, static_cast<Index>(mesh.vertices.size()));
    if (fresh)
      for (std::size_t k = 1; k < n; ++k) mesh.vertices.push_back(unit(between(a, b, k)));
    return place->second + static_cast<Index>(i - 1);
  };
  std::vector<Index> row, next;
  for (const auto& [a, b, c] : faces) {
    row.assign(1, a);
    for (std::size_t r = 1; r <= n; ++r) {
      next.clear();
      for (std::size_t k = 0; k <= r; ++k) {
        if (r == n) {
          next.push_back(on_edge(b, c, k));
        } else if (k == 0) {
          next.push_back(on_edge(a, b, r));
        } else if (k == r) {
          next.push_back(on_edge(a, c, r));
        } else {
          const double u = static_cast<double>(n - r), v = static_cast<double>(r - k),
                       w = static_cast<double>(k);
          Point p;
          for (int d = 0; d < 3; ++d)
            p[d] = (u * corners[a][d] + v * corners[b][d]) + w * corners[c][d];
          next.push_back(static_cast<Index>(mesh.vertices.size()));
          mesh.vertices.push_back(unit(p));
        }
      }
      for (std::size_t k = 0; k < r; ++k) {
        mesh.triangles.push_back({row[k], next[k], next[k + 1]});
        if (k + 1 < r) mesh.triangles.push_back({row[k], next[k + 1], row[k + 1]});
      }
      row.swap(next);
    }
  }
  return mesh;
}

/// The numbers (around, across) with 2 around across nearest to `polygons`, and among those
/// the one whose proportion is nearest to the one wanted; at least `least_around` and 3.
std::pair<std::size_t, std::size_t> nearest_grid(std::size_t polygons, double proportion,
                                                 std::size_t least_around) {
  const double half = static_cast<double>(polygons) / 2;
  const auto ideal = static_cast<std::size_t>(std::sqrt(half / proportion));
  std::pair<std::size_t, std::size_t> best{least_around, 3};
  const auto score = [&](std::pair<std::size_t, std::size_t> grid) {
    const auto [around, across] = grid;
    return std::pair(difference(2 * around * across, polygons),
                     difference(across, std::max<std::size_t>(ideal, 3)));
  };
  const std::size_t spread = ideal / 4 + 2;
  for (std::size_t across = std::max<std::size_t>(ideal > spread ? ideal - spread : 3, 3);
       across <= ideal + spread; ++across) {
    const auto around = std::max<std::size_t>(
        static_cast<std::size_t>(std::llround(half / static_cast<double>(across))), least_around);
    if (score({around, across}) < score(best)) best = {around, across};
  }
  return best;
}

/// A tube closed on itself: `around` rings of `across` corners, from a function of (turn along the
/// tube, turn across it) whose cross product of derivatives points outward.
template <class Surface>
TriangleMesh closed_tube(std::size_t around, std::size_t across, Surface&& surface) {
  TriangleMesh mesh;
  mesh.vertices.reserve(around * across);
  mesh.triangles.reserve(2 * around * across);
  for (std::size_t i = 0; i < around; ++i)
    for (std::size_t j = 0; j < across; ++j)
      mesh.vertices.push_back(surface(static_cast<double>(i) / static_cast<double>(around),
                                      static_cast<double>(j) / static_cast<double>(across)));
  for (std::size_t i = 0; i < around; ++i)
    for (std::size_t j = 0; j < across; ++j) {
      const auto at = [&](std::size_t di, std::size_t dj) {
        return static_cast<Index>((i + di) % around * across + (j + dj) % across);
      };
      mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  return mesh;
}

TriangleMesh round_ring(std::size_t polygons, double ring, double tube) {
  const auto [around, across] = nearest_grid(polygons, ring / tube, 3);
  return closed_tube(around, across, [&](double u, double v) -> Point {
    const auto [cu, su] = cosine_sine(u);
    const auto [cv, sv] = cosine_sine(v);
    const double r = ring + tube * cv;
    return {r * cu, r * su, tube * sv};
  });
}

TriangleMesh torus(std::size_t polygons) { return round_ring(polygons, 0.7, 0.3); }
TriangleMesh ring(std::size_t polygons) { return round_ring(polygons, 0.85, 0.15); }

/// A tube round the trefoil that winds twice about the axis and three times through the hole of a
/// torus. The torus's normal and its product with the tangent span the tube's cross-section: they
/// close on themselves, as the Frenet frame's twist need not.
TriangleMesh knot(std::size_t polygons) {
  constexpr double ring = 0.58, hole = 0.28, tube = 0.13;
  const auto [around, across] = nearest_grid(polygons, 12, 25);
  return closed_tube(around, across, [](double u, double v) -> Point {
    const auto [cp, sp] = cosine_sine(2 * u);
    const auto [cq, sq] = cosine_sine(3 * u);
    const double r = ring + hole * cq;
    const Point normal{cq * cp, cq * sp, sq};
    const Point tangent =
        unit({-3 * hole * sq * cp - 2 * r * sp, -3 * hole * sq * sp + 2 * r * cp, 3 * hole * cq});
    const Point side = cross(tangent, normal);
    const auto [cv, sv] = cosine_sine(-v);
    Point p;
    for (int d = 0; d < 3; ++d) p[d] = tube * (cv * normal[d] + sv * side[d]);
    return {p[0] + r * cp, p[1] + r * sp, p[2] + hole * sq};
  });
}

TriangleMesh icosphere(std::size_t polygons) {
  return geodesic_sphere(nearest_square(polygons, 20));
}

/// A sphere whose radius follows a Chebyshev polynomial of degree 8 in each coordinate.
TriangleMesh bumpy_sphere(std::size_t polygons) {
  TriangleMesh mesh = geodesic_sphere(nearest_square(polygons, 20));
  const auto wave = [](double x) {
    const double t2 = 2 * x * x - 1, t4 = 2 * t2 * t2 - 1;
    return 2 * t4 * t4 - 1;
  };
  for (Point& p : mesh.vertices) {
    const double r = 0.8 + 0.2 / 3 * ((wave(p[0]) + wave(p[1])) + wave(p[2]));
    for (int d = 0; d < 3; ++d) p[d] *= r;
  }
  return mesh;
}

/// A small geodesic sphere with a pyramid on every face.
TriangleMesh star(std::size_t polygons) {
  const TriangleMesh core = geodesic_sphere(nearest_square(polygons, 60));
  TriangleMesh mesh;
  mesh.vertices = core.vertices;
  for (Point& p : mesh.vertices)
    for (int d = 0; d < 3; ++d) p[d] *= 0.4;
  mesh.vertices.reserve(core.vertices.size() + core.triangles.size());
  mesh.triangles.reserve(3 * core.triangles.size());
  for (const auto& [a, b, c] : core.triangles) {
    Point tip;
    for (int d = 0; d < 3; ++d)
      tip[d] = (core.vertices[a][d] + core.vertices[b][d]) + core.vertices[c][d];
    const auto t = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.push_back(unit(tip));
    mesh.triangles.push_back({a, b, t});
    mesh.triangles.push_back({b, c, t});
    mesh.triangles.push_back({c, a, t});
  }
  return mesh;
}

/// A cube whose sides are grids: a, b and c squares along x, y and z make 4 (ab + bc + ca)
/// triangles.
std::array<std::size_t, 3> nearest_box(std::size_t polygons) {
  const std::size_t n = nearest_square(polygons, 12);
  std::array<std::size_t, 3> best{n, n, n};
  const auto count = [](const std::array<std::size_t, 3>& s) {
    return 4 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]);
  };
  const std::size_t low = n > 5 ? n - 5 : 1;
  for (std::size_t a = low; a <= n + 5; ++a)
    for (std::size_t b = a; b <= n + 5; ++b)
      for (std::size_t c = b; c <= n + 5; ++c)
        if (difference(count({a, b, c}), polygons) < difference(count(best), polygons))
          best = {a, b, c};
  return best;
}

TriangleMesh box(std::size_t polygons) {
  const std::array<std::size_t, 3> squares = nearest_box(polygons);
  TriangleMesh mesh;
  std::map<std::array<std::size_t, 3>, Index> made;
  const auto vertex = [&](const std::array<std::size_t, 3>& at) {
    const auto [place, fresh] = made.try_emplace(at, static_cast<Index>(mesh.vertices.size()));
    if (fresh) {
      Point p;
      for (std::size_t d = 0; d < 3; ++d)
        p[static_cast<int>(d)] =
            0.5 * (2 * static_cast<double>(at[d]) / static_cast<double>(squares[d]) - 1);
      mesh.vertices.push_back(p);
    }
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const std::size_t level : {std::size_t{0}, squares[axis]})
      for (std::size_t i = 0; i < squares[u]; ++i)
        for (std::size_t j = 0; j < squares[v]; ++j) {
          const auto at = [&](std::size_t di, std::size_t dj) {
            std::array<std::size_t, 3> place{};
            place[axis] = level, place[u] = i + di, place[v] = j + dj;
            return vertex(place);
          };
          std::array<Index, 4> q = {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (level == 0) std::swap(q[1], q[3]);
          mesh.triangles.push_back({q[0], q[1], q[2]});
          mesh.triangles.push_back({q[0], q[2], q[3]});
        }
  }
  return mesh;
}

constexpr FormulaMesh list[] = {
    {"icosphere", "a sphere of 20 n^2 nearly equal triangles; convex", icosphere},
    {"torus", "a ring with a round tube; concave, one hole", torus},
    {"ring", "the same, thinner, its hole 0.7 in radius; concave", ring},
    {"knot", "a tube tied into a trefoil knot; concave, one hole", knot},
    {"bumpy-sphere", "a sphere of 20 n^2 triangles with dents and bumps; concave", bumpy_sphere},
    {"box", "the unit cube with gridded sides; convex, coplanar triangles", box},
    {"star", "a ball with 20 n^2 sharp spikes of 3 triangles each; concave", star},
};

}  // namespace

std::span<const FormulaMesh> formula_meshes() { return list; }

std::string formula_mesh_names() { return joined(list, &FormulaMesh::name); }

TriangleMesh formula_mesh(std::string_view name, std::size_t polygons) {
  if (polygons == 0 || polygons > most_polygons)
    throw Unusable(std::to_string(polygons) + " polygons: must be 1 to " +
                   std::to_string(most_polygons));
  for (const FormulaMesh& entry : list)
    if (entry.name == name) return entry.make(polygons);
  throw Unusable("no mesh '" + std::string(name) + "'; available: " + formula_mesh_names());
}

}  // namespace bvlab
