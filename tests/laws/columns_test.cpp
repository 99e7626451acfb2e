// SPDX-License-Identifier: BSD-3-Clause
/// What is found a register or a block at a time is what a search of all points finds, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <span>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/geometry/triangle_columns.hpp"
#include "hierarchies/volumes/slab_box.hpp"
#include "hierarchies/wide/fitting.hpp"
#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/support_map.hpp"

namespace bvlab {
namespace {

using Box = SlabBox<float>;

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

/// A mesh and its triangles in columns, in an order in which neighbours are far apart or near.
struct InColumns {
  TriangleMesh mesh;
  std::vector<std::uint32_t> order;
  Threads alone;
  TriangleColumns columns;
  SlabBoxColumns<Box> boxes;
  std::vector<Triangle> triangles;

  InColumns(TriangleMesh from, bool shuffled)
      : mesh(std::move(from)),
        order(ordered(mesh.triangles.size(), shuffled)),
        columns(mesh, order, alone),
        boxes(columns, alone) {
    for (const auto k : order) triangles.push_back(mesh.corners(k));
  }
  static std::vector<std::uint32_t> ordered(std::size_t count, bool shuffled) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::mt19937 random(3);
    if (shuffled) std::shuffle(order.begin(), order.end(), random);
    return order;
  }
  std::span<const Triangle> range(std::size_t begin, std::size_t end) const {
    return std::span(triangles).subspan(begin, end - begin);
  }
  static std::span<const Vec3<double>> points(std::span<const Triangle> range) {
    return {range[0].data(), 3 * range.size()};
  }
};

/// Ranges of one triangle, of fewer than a register has lanes, of parts of blocks, of many blocks.
std::vector<std::pair<std::size_t, std::size_t>> ranges_of(std::size_t count) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges{
      {0, count}, {1, count}, {63, count - 1}, {64, count / 2}};
  for (std::size_t size : {1, 2, 3, 7, 8, 9, 16, 17, 63, 64, 65, 129, 1023, 1024, 1025, 1100, 2500})
    for (const std::size_t begin : {std::size_t{0}, std::size_t{5}, std::size_t{60}, count - size})
      if (begin + size <= count) ranges.emplace_back(begin, begin + size);
  return ranges;
}

/// Shapes with many equal coordinates, and a few triangles without area.
std::vector<TriangleMesh> meshes() {
  std::vector<TriangleMesh> all{formula_mesh("torus", 6000), formula_mesh("star", 3100),
                                formula_mesh("icosphere", 5120)};
  TriangleMesh flat = formula_mesh("torus", 3000);
  for (std::size_t k = 0; k < flat.triangles.size(); k += 5)
    flat.triangles[k][2] = flat.triangles[k][k % 2];
  all.push_back(flat);
  return all;
}

TEST(Columns, VolumesAreThoseFittedToTriangles) {
  for (const auto& mesh : meshes())
    for (const bool shuffled : {false, true}) {
      const InColumns all(mesh, shuffled);
      for (const auto& [begin, end] : ranges_of(all.order.size())) {
        const auto range = all.range(begin, end);
        const Box box = all.boxes.volume(begin, end, all.columns.box(begin, end));
        EXPECT_TRUE(same_bits(box, Box::enclosing(InColumns::points(range), range)))
            << begin << ' ' << end;
      }
    }
}

TEST(Columns, SpheresAreThoseAroundPoints) {
  for (const auto& mesh : meshes()) {
    const InColumns all(mesh, false);
    for (const auto& [begin, end] : ranges_of(all.order.size())) {
      const auto points = InColumns::points(all.range(begin, end));
      const NodeSphere sphere = sphere_around(all.columns, begin, end, all.columns.box(begin, end));
      const Vec3<double> centre(sphere.centre[0], sphere.centre[1], sphere.centre[2]);
      double farthest = 0;
      for (const auto& p : points) farthest = std::max(farthest, squared_norm<double>(p - centre));
      EXPECT_EQ(all.columns.farthest_squared(begin, end, centre), farthest);
      const NodeSphere other(points);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(sphere.centre[k], other.centre[k]);
      EXPECT_NEAR(sphere.radius, other.radius, 2e-7 * other.radius);
      for (const auto& p : points) EXPECT_LE((p - centre).norm(), sphere.radius);
    }
  }
}

template <int F>
void expect_lanes(const InColumns& all) {
  for (std::size_t first = 0; first + F <= all.order.size(); first += 37)
    for (std::size_t count : {1, 2, F / 2 + 1, F}) {
      if (count > F) continue;
      Over<Box, Batch<float, F>> lanes;
      all.boxes.put_each(first, count, lanes);
      for (std::size_t lane = 0; lane < F; ++lane) {
        const std::size_t k = first + std::min(lane, count - 1);
        const auto one = all.range(k, k + 1);
        EXPECT_TRUE(same_bits(lane_of<Box>(lanes, static_cast<int>(lane)),
                              Box::enclosing(InColumns::points(one), one)))
            << F << ": " << first << ' ' << count << ' ' << lane;
      }
    }
}

TEST(Columns, LanesAreVolumesOfTriangles) {
  for (const auto& mesh : meshes()) {
    const InColumns all(mesh, false);
    expect_lanes<2>(all), expect_lanes<4>(all), expect_lanes<8>(all), expect_lanes<16>(all);
  }
}

/// Of very large ranges the normals' sums are rounded in another order. Here they have a direction,
/// so that the slabs agree up to that.
TEST(Columns, VeryLargeRangesAreEnclosed) {
  const InColumns all(formula_mesh("torus", 60000), false);
  const std::size_t half = all.order.size() / 2;
  ASSERT_GT(half - 7, SlabBoxColumns<Box>::very_large);
  for (const auto& [begin, end] : {std::pair<std::size_t, std::size_t>{0, half}, {7, half}}) {
    const auto range = all.range(begin, end);
    const Box box = all.boxes.volume(begin, end, all.columns.box(begin, end));
    const Box other = Box::enclosing(InColumns::points(range), range);
    EXPECT_TRUE(same_bits(box.half, other.half));
    EXPECT_NEAR(box.width, other.width, 1e-5F * other.width);
    for (const auto& p : InColumns::points(range))
      ASSERT_TRUE(contains(box, Vec3<long double>(p.cast<long double>())));
  }
}

/// Every sample is the first of the highest points.
TEST(Columns, SupportMapFindsTheHighestPoint) {
  for (const auto& mesh : meshes()) {
    const MeshSphere sphere(mesh);
    const SupportMap map(mesh, sphere.centre);
    std::vector<Vec3<double>> used;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (std::ranges::any_of(mesh.triangles,
                              [v](const auto& t) { return std::ranges::count(t, v) > 0; }))
        used.push_back(mesh.vertices[v] - sphere.centre);
    std::size_t entry = 0;
    for (int face = 0; face < 6; ++face)
      for (int k = 0; k < SupportMap::row * SupportMap::row; ++k) {
        Vec3<double> g;
        g[face / 2] = face % 2 ? -1 : 1;
        g[(face / 2 + 1) % 3] = 2.0 * (k / SupportMap::row) / SupportMap::cells - 1;
        g[(face / 2 + 2) % 3] = 2.0 * (k % SupportMap::row) / SupportMap::cells - 1;
        const auto highest = std::ranges::max_element(
            used, {}, [&g](const Vec3<double>& p) { return dot<double>(p, g); });
        const SupportSample& sample = map.table()[entry++];
        for (int j = 0; j < 3; ++j) EXPECT_EQ(sample.point[j], static_cast<float>((*highest)[j]));
        EXPECT_GE(sample.height, dot<double>(*highest, g));
        EXPECT_LE(sample.height, dot<double>(*highest, g) + 1e-6 * sphere.radius);
      }
  }
}

}  // namespace
}  // namespace bvlab
