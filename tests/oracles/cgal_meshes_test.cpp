// SPDX-License-Identifier: BSD-3-Clause
/// Meshes as they are met with: a sample of CGAL's data set, open, not manifold and intersecting
/// themselves among them. Every volume, strategy and query against all pairs of triangles, decided
/// in rational numbers.
#include "experiments/scenes/cgal_meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/posed_triangles.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/queries.hpp"

namespace bvlab {
namespace {

constexpr std::size_t most_triangles = 250;

struct Sample {
  std::string name;
  TriangleMesh mesh;
};

/// Not manifold: one edge bounds three triangles, and one triangle stands twice.
Sample with_fin(Sample from) {
  auto& [name, mesh] = from;
  const auto [i, j, k] = mesh.triangles[0];
  const Vec3<double> tip = 2 * mesh.vertices[i] - mesh.vertices[k];
  mesh.triangles.push_back({i, j, static_cast<std::uint32_t>(mesh.vertices.size())});
  mesh.vertices.push_back(tip);
  mesh.triangles.push_back(mesh.triangles[1]);
  name += " with a fin";
  return from;
}

/// All small meshes there are, and some large ones simplified (which keeps what is open open, and
/// cuts apart what is not manifold).
std::vector<Sample> sample() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(mesh_directory()))
    if (entry.path().extension() == ".off" && entry.file_size() < 20000)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Sample> meshes;
  for (const auto& file : files) try {
      TriangleMesh mesh = read_mesh(file.string());
      if (mesh.triangles.size() <= most_triangles)
        meshes.push_back({file.stem().string(), std::move(mesh)});
    } catch (const Unusable&) {
      // Some hold points alone.
    }
  for (const char* name : {"elephant-with-holes", "mech-holes-shark", "blobby_3cc", "anchor",
                           "knot1", "hand", "triceratops", "rotor"})
    meshes.push_back(
        {name, simplified(read_mesh((mesh_directory() / name).string() + ".off"), most_triangles)});
  // None of the small ones has an edge with more than two triangles.
  for (std::size_t i = 0; i < 4; ++i) meshes.push_back(with_fin(meshes[meshes.size() - 5]));
  return meshes;
}

/// How many edges bound one triangle, and how many bound three or more.
std::pair<std::size_t, std::size_t> odd_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++sides[std::minmax(t[k], t[(k + 1) % 3])];
  std::pair<std::size_t, std::size_t> odd;
  for (const auto& [edge, count] : sides) odd.first += count == 1, odd.second += count > 2;
  return odd;
}

bool intersects_itself(const TriangleMesh& mesh) {
  for (std::size_t s = 0; s < mesh.triangles.size(); ++s)
    for (std::size_t t = 0; t < s; ++t) {
      const auto &a = mesh.triangles[s], &b = mesh.triangles[t];
      if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end()) continue;
      const Triangle one = mesh.corners(s), other = mesh.corners(t);
      if (boxes_meet(one, other) && oracle::intersect(one, other)) return true;
    }
  return false;
}

Trace trace_of(const TriangleMesh& mesh) {
  RandomWalk walk;
  walk.objects = 2;
  walk.frames = 6;
  walk.side = {1.2, Length::Unit::body};
  walk.step = {0.3, Length::Unit::body};
  walk.degrees = 20;
  walk.teleport = 0.2;
  walk.seed = mesh.triangles.size();
  const Extent extents[] = {extent_of(mesh)};
  auto array = walk.generate(extents, {});
  return {array.shape[0], array.shape[1], std::move(array.data)};
}

ReplayResult brute_force(const TriangleMesh& mesh, const Trace& trace) {
  ReplayResult truth;
  std::vector<Pose> poses(2);
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    std::array<std::vector<Triangle>, 2> triangles_of_body;
    for (std::size_t i = 0; i < 2; ++i) triangles_of_body[i] = posed_triangles(mesh, poses[i]);
    double least = std::numeric_limits<double>::infinity();
    const std::size_t before = truth.contacts.size();
    for (std::uint32_t s = 0; s < triangles_of_body[0].size(); ++s)
      for (std::uint32_t t = 0; t < triangles_of_body[1].size(); ++t) {
        const Triangle &a = triangles_of_body[0][s], &b = triangles_of_body[1][t];
        if (boxes_meet(a, b) && oracle::intersect(a, b))
          truth.contacts.push_back({static_cast<std::uint32_t>(frame), 0, 1, s, t});
        least = std::min(least, distance(a, b).distance);
      }
    truth.touching.push_back(truth.contacts.size() > before);
    truth.distances.push_back(least);
  }
  return truth;
}

void expect_equal(const ReplayResult& found, const ReplayResult& truth, std::string_view query) {
  EXPECT_TRUE(query != "touching" || found.touching == truth.touching);
  EXPECT_TRUE(query != "contacts" || found.contacts == truth.contacts);
  if (query != "distance") return;
  ASSERT_EQ(found.distances.size(), truth.distances.size());
  for (std::size_t i = 0; i < truth.distances.size(); ++i)
    EXPECT_NEAR(found.distances[i], truth.distances[i], 1e-12 * truth.distances[i]);
}

void expect_truth_of_all(const Sample& each, const Trace& trace, const ReplayResult& truth) {
  const std::span<const TriangleMesh> meshes(&each.mesh, 1);
  for (const auto& volume : volumes())
    for (const auto& strategy : strategies())
      for (const auto& query : queries()) {
        Variant variant;
        variant.volume = volume.name;
        variant.strategy = strategy.name;
        variant.query = query.name;
        SCOPED_TRACE(each.name + ' ' + variant.volume + ' ' + variant.strategy + ' ' +
                     variant.query);
        expect_equal(replay(meshes, trace, variant, {}), truth, query.name);
      }
}

TEST(CgalMeshes, EveryVariantAgreesWithRationalNumbers) {
  if (!std::filesystem::exists(mesh_directory() / "bunny00.off"))
    GTEST_SKIP() << "no meshes in " << mesh_directory() << ": experiments/setup unpacks them";
  std::size_t open = 0, not_manifold = 0, crossing = 0, touching = 0, apart = 0;
  const auto meshes = sample();
  for (const auto& each : meshes) {
    const auto [boundary, many] = odd_edges(each.mesh);
    open += boundary > 0, not_manifold += many > 0, crossing += intersects_itself(each.mesh);
    const Trace trace = trace_of(each.mesh);
    const ReplayResult truth = brute_force(each.mesh, trace);
    for (const bool touches : truth.touching) ++(touches ? touching : apart);
    expect_truth_of_all(each, trace, truth);
  }
  // The sample is what it is said to be.
  EXPECT_GE(meshes.size(), 40u);
  EXPECT_GE(open, 10u);
  EXPECT_GE(not_manifold, 3u);
  EXPECT_GE(crossing, 3u);
  EXPECT_GE(touching, 50u);
  EXPECT_GE(apart, 20u);
}

}  // namespace
}  // namespace bvlab
