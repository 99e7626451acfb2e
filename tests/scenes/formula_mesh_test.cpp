// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/formula_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/circle.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

double signed_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

/// Every directed edge once, and its opposite once; every vertex used.
void expect_closed_and_oriented(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::set<std::uint32_t> used;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(t[k], mesh.vertices.size());
      ASSERT_NE(t[k], t[(k + 1) % 3]);
      ++edges[{t[k], t[(k + 1) % 3]}];
      used.insert(t[k]);
    }
  for (const auto& [edge, times] : edges) {
    ASSERT_EQ(times, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(used.size(), mesh.vertices.size());
}

long euler_characteristic(const TriangleMesh& mesh) {
  const auto triangles = static_cast<long>(mesh.triangles.size());
  return static_cast<long>(mesh.vertices.size()) - triangles * 3 / 2 + triangles;
}

TEST(FormulaMesh, ClosedOrientedOutwardAndOfItsGenus) {
  for (const FormulaMesh& entry : formula_meshes())
    for (const std::size_t polygons : {1, 4, 20, 100, 500, 1777, 5000}) {
      SCOPED_TRACE(std::string(entry.name) + " " + std::to_string(polygons));
      const TriangleMesh mesh = formula_mesh(entry.name, polygons);
      expect_closed_and_oriented(mesh);
      const bool has_hole = entry.name == "torus" || entry.name == "ring" || entry.name == "knot";
      EXPECT_EQ(euler_characteristic(mesh), has_hole ? 0 : 2);
      EXPECT_GT(signed_volume(mesh), 0);
      double reach = 0;
      for (const auto& v : mesh.vertices) reach = std::max(reach, v.norm());
      EXPECT_LE(reach, 1 + 1e-12);
      if (polygons >= 100) {
        EXPECT_GT(reach, 0.8);
      }
    }
}

TEST(FormulaMesh, NoFamilyMemberIsNearerToTheCountAsked) {
  const auto count = [](std::string_view name, std::size_t polygons) {
    return formula_mesh(name, polygons).triangles.size();
  };
  EXPECT_EQ(count("icosphere", 500), 500u);
  EXPECT_EQ(count("bumpy-sphere", 1), 20u);
  EXPECT_EQ(count("icosphere", 51), 80u);  // 80 is 29 off, 20 is 31 off
  EXPECT_EQ(count("icosphere", 49), 20u);
  EXPECT_EQ(count("star", 500), 540u);
  EXPECT_EQ(count("box", 12), 12u);
  for (const std::size_t polygons : {500u, 1000u, 10000u}) {
    EXPECT_EQ(count("torus", polygons), polygons);
    EXPECT_EQ(count("knot", polygons), polygons);
    EXPECT_NEAR(static_cast<double>(count("box", polygons)), static_cast<double>(polygons),
                0.01 * static_cast<double>(polygons));
  }
}

TEST(FormulaMesh, SizesAreThoseOfTheSurface) {
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(signed_volume(formula_mesh("icosphere", 20000)), 4 * pi / 3, 0.01);
  EXPECT_NEAR(signed_volume(formula_mesh("torus", 20000)), 2 * pi * pi * 0.7 * 0.09, 0.01);
  EXPECT_NEAR(signed_volume(formula_mesh("box", 300)), 1, 1e-12);
}

/// Triangles that share no corner share no point: the surfaces bound solids.
TEST(FormulaMesh, NoSurfaceMeetsItself) {
  for (const FormulaMesh& entry : formula_meshes())
    for (const std::size_t polygons : {1, 150, 500, 1200}) {
      SCOPED_TRACE(std::string(entry.name) + " " + std::to_string(polygons));
      const TriangleMesh mesh = formula_mesh(entry.name, polygons);
      std::size_t meetings = 0;
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const auto &s = mesh.triangles[i], &t = mesh.triangles[j];
          const bool neighbours =
              std::find_first_of(s.begin(), s.end(), t.begin(), t.end()) != s.end();
          meetings += !neighbours && intersect(mesh.corners(i), mesh.corners(j));
        }
      EXPECT_EQ(meetings, 0u);
    }
}

TEST(FormulaMesh, FaultsAreNamed) {
  EXPECT_THROW(formula_mesh("icosphere", 0), Unusable);
  EXPECT_THROW(formula_mesh("icosphere", most_polygons + 1), Unusable);
  try {
    formula_mesh("teapot", 500);
    FAIL();
  } catch (const Unusable& error) {
    EXPECT_STREQ(
        error.what(),
        "no mesh 'teapot'; available: icosphere, torus, ring, knot, bumpy-sphere, box, star");
  }
}

TEST(Circle, AgreesWithTheCLibraryAndIsExactAtQuarters) {
  for (int i = -1000; i <= 1000; ++i) {
    const double turns = i / 321.0;
    const auto [cosine, sine] = cosine_sine(turns);
    const long double angle = 2 * std::acos(-1.0L) * turns;
    EXPECT_NEAR(cosine, static_cast<double>(std::cos(angle)), 4e-16);
    EXPECT_NEAR(sine, static_cast<double>(std::sin(angle)), 4e-16);
  }
  EXPECT_EQ(cosine_sine(0.25), std::pair(-0.0, 1.0));
  EXPECT_EQ(cosine_sine(-0.5), std::pair(-1.0, 0.0));
}

}  // namespace
}  // namespace bvlab
