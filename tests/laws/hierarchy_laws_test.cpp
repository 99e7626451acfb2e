// SPDX-License-Identifier: BSD-3-Clause
/// Every volume over every build: a tree with all triangles in it once, each node around its own.
#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/hierarchy.hpp"
#include "hierarchies/volumes.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "tests/types_of.hpp"

namespace bvlab {
namespace {

/// Degenerate but legal: repeated, flat and point-like triangles, alone or in a crowd.
std::vector<TriangleMesh> hostile_meshes() {
  std::vector<TriangleMesh> meshes;
  meshes.push_back({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  meshes.push_back({{{1, 2, 3}}, {{0, 0, 0}}});
  meshes.push_back({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}});
  for (int i = 0; i < 33; ++i) meshes.back().triangles.push_back({0, 1, 2});
  meshes.push_back(formula_mesh("star", 300));
  for (auto& v : meshes.back().vertices) v = v * 1e-9 + Vec3<double>(1e5, -1e6, 3);
  meshes.push_back(formula_mesh("torus", 500));
  return meshes;
}

template <class V>
class HierarchyLaws : public ::testing::Test {};
TYPED_TEST_SUITE(HierarchyLaws, TypesOf<Volumes>);

/// The corners, and points between that are off by no more than rounding, which is monotone.
std::vector<Vec3<long double>> points_of(const Triangle& corners) {
  std::vector<Vec3<long double>> points;
  for (const auto& corner : corners) points.push_back(corner.cast<long double>());
  for (std::size_t i = 0; i < 3; ++i) points.push_back((points[i] + points[(i + 1) % 3]) / 2);
  for (std::size_t i = 0; i < 3; ++i) points.push_back((points[i] + points[(i + 1) % 3 + 3]) / 2);
  return points;
}

Triangle about(const Vec3<double>& origin, Triangle triangle) {
  for (auto& corner : triangle) corner -= origin;
  return triangle;
}

/// Checks the subtree and gives the triangles below it.
template <class V>
std::vector<std::uint32_t> check(const Hierarchy<V>& h, std::uint32_t node,
                                 const TriangleMesh& mesh, std::uint32_t leaf_size,
                                 std::size_t& visited) {
  ++visited;
  std::vector<std::uint32_t> below;
  const auto& n = h.node(node);
  if (h.is_leaf(node)) {
    EXPECT_LE(n.count, leaf_size);
    for (std::uint32_t i = 0; i < n.count; ++i) below.push_back(h.primitive(n.first + i));
  } else {
    EXPECT_GT(n.first, node);
    for (const auto child : {n.first, n.first + 1}) {
      const auto more = check(h, child, mesh, leaf_size, visited);
      below.insert(below.end(), more.begin(), more.end());
    }
  }
  const PlacementOf<V> here;
  for (const auto triangle : below)
    for (const auto& point : points_of(about(h.extent().origin, mesh.corners(triangle))))
      EXPECT_TRUE(contains(posed(h.volume(node), here), point));
  return below;
}

template <class V>
void check_all(const Hierarchy<V>& h, const TriangleMesh& mesh, std::uint32_t leaf_size) {
  std::size_t visited = 0;
  const auto all = check(h, 0, mesh, leaf_size, visited);
  EXPECT_EQ(visited, h.size());
  EXPECT_EQ(all.size(), mesh.triangles.size());
  EXPECT_EQ(std::set(all.begin(), all.end()).size(), mesh.triangles.size());
}

TYPED_TEST(HierarchyLaws, EveryTriangleStandsInOneLeafAndInsideAllAbove) {
  for (const auto& mesh : hostile_meshes())
    for (const std::uint32_t leaf_size : {1u, 2u, 7u})
      Builds::for_each([&](auto build) {
        const Hierarchy<TypeParam> h(mesh, decltype(build)::type::topology(mesh, leaf_size));
        check_all(h, mesh, leaf_size);
      });
}

TYPED_TEST(HierarchyLaws, SoItIsWithTightVolumes) {
  for (const auto& mesh : hostile_meshes())
    check_all(Hierarchy<TypeParam>(mesh, builds::TopDownPrincipal::topology(mesh, 2), Fit::tight),
              mesh, 2);
}

/// Vertices move a little, then anywhere, then onto one point.
TYPED_TEST(HierarchyLaws, SoItIsAfterARefit) {
  for (auto mesh : hostile_meshes()) {
    Hierarchy<TypeParam> h(mesh, builds::TopDownPrincipal::topology(mesh, 2));
    std::mt19937 random(1);
    for (const double amount : {1e-3, 10.0, 1e7}) {
      std::uniform_real_distribution<double> shift(-amount, amount);
      for (auto& v : mesh.vertices) v += Vec3<double>(shift(random), shift(random), shift(random));
      h.refit(mesh);
      check_all(h, mesh, 2);
    }
    for (auto& v : mesh.vertices) v = Vec3<double>(1, 2, 3);
    h.refit(mesh);
    check_all(h, mesh, 2);
    EXPECT_LT(h.extent().radius, 1e-12);
  }
}

/// What a tight fit is for: over meshes whose patches are no ellipsoids, less surface.
TEST(TightBoxes, AreSmallerThanThoseOfPrincipalAxes) {
  const auto half_surface = [](const Hierarchy<Obb<float>>& h) {
    double sum = 0;
    for (std::uint32_t i = 0; i < h.size(); ++i)
      sum += detail::half_surface(h.volume(i).half.template cast<double>());
    return sum;
  };
  for (const char* name : {"star", "torus", "knot"}) {
    const TriangleMesh mesh = formula_mesh(name, 500);
    const Topology topology = builds::TopDownPrincipal::topology(mesh, 1);
    EXPECT_LT(half_surface(Hierarchy<Obb<float>>(mesh, topology, Fit::tight)),
              0.95 * half_surface(Hierarchy<Obb<float>>(mesh, topology)))
        << name;
  }
}

TEST(TightRectangles, AreSmallerThanThoseOfPrincipalAxes) {
  const auto surface = [](const Hierarchy<Rss<float>>& h) {
    double sum = 0;
    for (std::uint32_t i = 0; i < h.size(); ++i) {
      const auto& [centre, side, half, radius] = h.volume(i);
      const double across = half[0] + half[1];
      sum += 8.0 * half[0] * half[1] + 4 * M_PI * radius * (across + radius);
    }
    return sum;
  };
  for (const char* name : {"star", "torus", "knot"}) {
    const TriangleMesh mesh = formula_mesh(name, 500);
    const Topology topology = builds::TopDownPrincipal::topology(mesh, 1);
    EXPECT_LT(surface(Hierarchy<Rss<float>>(mesh, topology, Fit::tight)),
              0.9 * surface(Hierarchy<Rss<float>>(mesh, topology)))
        << name;
  }
}

TEST(TightRectangles, AreNeverWorse) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 200; ++round) {
    const Vec3<double> stretch(1, std::exp(normal(random)), std::exp(normal(random)));
    std::vector<Vec3<double>> points;
    for (int i = 0; i < 30; ++i) {
      Vec3<double> p(normal(random), normal(random), normal(random));
      points.push_back(p.normalized().cwiseProduct(stretch));
    }
    const Mat3<double> axes = principal_axes(points);
    EXPECT_LE(tight_swept_rectangle(axes, points).surface(),
              swept_rectangle(axes, points).surface());
  }
}

/// Of the caps and the cone between them, the tight one has less or as much.
TEST(TightShells, AreSmallerThanPublishedOnes) {
  const auto surface = [](const Shell<double>& s) {
    const double caps = s.outer * s.outer + s.inner * s.inner, c = std::max(s.cosine, -1.0);
    return (1 - c) * caps +
           (c > 0 ? std::sqrt(1 - c * c) : 0) * (s.outer * s.outer - s.inner * s.inner) / 2;
  };
  for (const char* name : {"star", "torus", "knot"}) {
    const TriangleMesh mesh = formula_mesh(name, 500);
    double tight = 0, published = 0;
    for (std::size_t first = 0; first + 20 <= mesh.triangles.size(); first += 10) {
      std::vector<Vec3<double>> points;
      std::vector<Triangle> triangles;
      for (std::size_t i = first; i < first + 20; ++i) {
        triangles.push_back(mesh.corners(i));
        points.insert(points.end(), triangles.back().begin(), triangles.back().end());
      }
      const double before = surface(Shell<double>::enclosing(points, triangles)),
                   after = surface(Shell<double>::tight(points, triangles));
      EXPECT_LE(after, before * (1 + 1e-9));
      published += before, tight += after;
    }
    EXPECT_LT(tight, 0.95 * published) << name;
  }
}

/// Of points that span less than space, exactly or but for something tiny, too: a needle's corners
/// coincide where they are projected along it.
TEST(TightBoxes, AxesAreOrthonormalWhateverThePoints) {
  std::mt19937_64 random(5);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  const double sizes[] = {0, 1e-300, 1e-200, 1e-160, 1e-20, 1e-16, 1e-8, 1};
  const auto expect_orthonormal = [](const Mat3<double>& rows) {
    const auto wide = rows.cast<long double>().eval();
    const auto defect =
        (wide * wide.transpose() - Eigen::Matrix<long double, 3, 3>::Identity()).norm();
    EXPECT_LE(defect, 4 * unit_roundoff<double>);
  };
  for (const double x : sizes)
    for (const double y : sizes)
      for (const double z : sizes)
        for (int variant = 0; variant < 8; ++variant) {
          Mat3<double> turn = Mat3<double>::Identity();
          if (variant & 1)
            turn = Eigen::Quaterniond(number(), number(), number(), number())
                       .normalized()
                       .toRotationMatrix();
          const Vec3<double> middle(variant & 2 ? number() : 0, variant & 2 ? number() : 0, 0);
          std::vector<Vec3<double>> points;
          std::vector<Triangle> triangles;
          for (int i = 0; i < 8; ++i)
            points.push_back(turn * Vec3<double>(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z) +
                             middle);
          // So many that those inside are dropped.
          if (variant & 4)
            for (int i = 0; i < 40; ++i) points.push_back(points[i % 3] / 2 + points[i % 8] / 2);
          for (std::size_t i = 0; i + 2 < points.size(); ++i)
            triangles.push_back({points[i], points[i + 1], points[i + 2]});
          for (const auto& start : {principal_axes(points), principal_axes(points, triangles)}) {
            expect_orthonormal(start);
            expect_orthonormal(tight_axes(start, points));
          }
        }
}

/// The vertices of a range of triangles in any order, each once; also of triangles that have one
/// vertex twice.
TEST(OrderedTriangles, HaveEachVertexOnce) {
  TriangleMesh mesh = formula_mesh("torus", 200);
  mesh.triangles[7] = {5, 5, 9}, mesh.triangles[8] = {4, 4, 4};
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937 random(7);
  std::shuffle(order.begin(), order.end(), random);
  Threads alone;
  const OrderedTriangles triangles(mesh, order, alone);
  for (std::uint32_t begin = 0; begin < order.size(); begin += 3)
    for (std::uint32_t end = begin + 1; end <= order.size(); end += 1 + end / 4) {
      std::set<std::uint32_t> vertices;
      for (std::uint32_t k = begin; k < end; ++k)
        vertices.insert(mesh.triangles[order[k]].begin(), mesh.triangles[order[k]].end());
      std::multiset<std::array<double, 3>> wanted, found;
      for (const std::uint32_t v : vertices)
        wanted.insert({mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]});
      for (const auto& p : triangles.points(begin, end)) found.insert({p[0], p[1], p[2]});
      ASSERT_EQ(found, wanted) << begin << " to " << end;
    }
}

/// A hull has all points on the left of its edges, whatever was dropped before: scattered points,
/// points of a grid, on a line, and in one place.
TEST(TightBoxes, HullHasAllPointsInside) {
  std::mt19937_64 random(6);
  std::vector<Eigen::Vector2d> hull;
  for (int round = 0; round < 400; ++round) {
    const int cells = std::array{1000000, 5, 2, 1}[static_cast<std::size_t>(round % 4)];
    std::uniform_int_distribution<int> cell(0, cells - 1);
    const bool on_a_line = round % 5 == 0;
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 2 + round; ++i) {
      const double x = 1.0 * cell(random) / cells, y = 1.0 * cell(random) / cells;
      points.emplace_back(x, on_a_line ? x / 4 : y);
    }
    auto left = points;
    detail::find_hull(left, hull);
    ASSERT_GE(hull.size(), 2u);
    for (std::size_t e = 0; e < hull.size(); ++e) {
      const Eigen::Vector2d side = hull[(e + 1) % hull.size()] - hull[e];
      for (const auto& p : points) {
        const Eigen::Vector2d q = p - hull[e];
        EXPECT_GE(side.x() * q.y() - side.y() * q.x(), -1e-15);
      }
    }
  }
}

/// A turned box is found again, but for what a last round may still gain, from principal axes that
/// are not its own.
TEST(TightBoxes, FindATurnedBox) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3<double>> points;
  for (int i = 0; i < 8; ++i)
    points.push_back(turn * Vec3<double>(i & 1 ? 3 : 0, i & 2 ? 2 : 0, i & 4 ? 1 : 0));
  // Many points at one corner pull the principal axes away.
  for (int i = 0; i < 50; ++i) points.push_back(points[7]);
  const auto box = Obb<double>::along(tight_axes(principal_axes(points), points), points);
  EXPECT_NEAR(box.half[0], 1.5, 1e-3);
  EXPECT_NEAR(box.half[1], 1.0, 1e-3);
  EXPECT_NEAR(box.half[2], 0.5, 1e-3);
}

}  // namespace
}  // namespace bvlab
