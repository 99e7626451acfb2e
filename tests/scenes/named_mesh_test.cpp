// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/named_mesh.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/cgal_meshes.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {
namespace {

TEST(SimplifyMesh, HasTheCountAskedAndTheShape) {
  const TriangleMesh fine = formula_mesh("bumpy-sphere", 8000);
  for (const std::size_t polygons : {500u, 501u, 1000u, 20u}) {
    const TriangleMesh coarse = simplified(fine, polygons);
    EXPECT_EQ(coarse.triangles.size(), polygons / 2 * 2);
    EXPECT_EQ(coarse.vertices.size(), coarse.triangles.size() / 2 + 2);  // still a sphere
    for (const auto& v : coarse.vertices) EXPECT_LT(v.norm(), 1.2);
  }
  EXPECT_EQ(simplified(fine, 8000).triangles, fine.triangles);
  EXPECT_EQ(simplified(fine, 500).vertices, simplified(fine, 500).vertices);
}

TEST(SimplifyMesh, BearsWhatIsNoManifold) {
  TriangleMesh mesh = formula_mesh("icosphere", 500);
  mesh.vertices.push_back({3, 0, 0});  // a fin on an edge, a triangle twice, and one without area
  const auto [i, j, k] = mesh.triangles[0];
  mesh.triangles.push_back({i, j, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
  mesh.triangles.push_back(mesh.triangles[7]);
  mesh.triangles.push_back({i, i, k});
  EXPECT_LE(simplified(mesh, 100).triangles.size(), 102u);
}

TEST(NamedMesh, IsKeptAndReadAgain) {
  const auto directory =
      std::filesystem::temp_directory_path() / ("bvlab named " + std::to_string(::getpid()));
  std::filesystem::create_directories(directory);
  EXPECT_EQ(named_mesh("torus", 500, directory).mesh.triangles.size(), 500u);
  EXPECT_TRUE(std::filesystem::is_empty(directory));
  EXPECT_EQ(named_mesh("bunny", 500, directory).name, "bumpy-sphere");  // says so

  write_off(directory / "bunny00.off", formula_mesh("knot", 2000));
  const NamedMesh first = named_mesh("bunny", 500, directory);
  EXPECT_EQ(first.name, "bunny");
  EXPECT_EQ(first.mesh.triangles.size(), 500u);
  EXPECT_TRUE(std::filesystem::exists(directory / "bunny-500.off"));
  std::filesystem::remove(directory / "bunny00.off");
  const NamedMesh again = named_mesh("bunny", 500, directory);
  EXPECT_EQ(again.mesh.vertices, first.mesh.vertices);
  EXPECT_EQ(again.mesh.triangles, first.mesh.triangles);
  EXPECT_THROW(named_mesh("../bunny", 500, directory), Unusable);
  EXPECT_THROW(named_mesh("dino", 500, directory), Unusable);
  EXPECT_THROW(named_mesh("bunny", 0, directory), Unusable);
  std::filesystem::remove_all(directory);
}

TEST(NamedMesh, SeveralStandInOneText) {
  const auto meshes = named_meshes("torus,box:12:2.5,star-hull:60", 100);
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[0].name, "torus");
  EXPECT_EQ(meshes[0].mesh.triangles, formula_mesh("torus", 100).triangles);
  EXPECT_EQ(meshes[1].mesh.triangles.size(), 12u);
  for (const auto& corner : meshes[1].mesh.vertices) EXPECT_EQ(corner.cwiseAbs().maxCoeff(), 1.25);
  EXPECT_EQ(meshes[2].name, "star-hull");
  for (const char* wrong : {"", "box:x", "box:12:0", "box:12:nan", "box:12:1:1", "teapot-hull"})
    EXPECT_THROW(named_meshes(wrong, 100), Unusable) << wrong;
}

TEST(NamedMesh, AHullIsConvexAndHoldsTheMesh) {
  const TriangleMesh whole = named_mesh("knot", 400).mesh, hull = named_mesh("knot-hull", 400).mesh;
  EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
  for (const auto& [i, j, k] : hull.triangles) {
    const Vec3<double> corner = hull.vertices[i];
    const Vec3<double> outward =
        (hull.vertices[j] - corner).cross(hull.vertices[k] - corner).normalized();
    for (const auto& v : whole.vertices) EXPECT_LE(outward.dot(v - corner), 1e-12);
  }
}

}  // namespace
}  // namespace bvlab
