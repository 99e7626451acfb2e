// SPDX-License-Identifier: BSD-3-Clause
/// Distances by closest features against brute force over all pairs of triangles: random poses,
/// coherent motion, parallel faces, touching, penetrating, and what they refuse.
#include "experiments/closest_features/closest_features.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "experiments/closest_features/v_clip.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/random.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "traversal/all_pairs.hpp"

namespace bvlab {
namespace {

std::vector<TriangleMesh> convex_meshes() {
  std::vector<TriangleMesh> meshes;
  for (auto& [name, mesh] : named_meshes(
           "icosphere:80,box:12,box:108,knot-hull:200,star-hull:60,bumpy-sphere-hull:320", 0))
    meshes.push_back(std::move(mesh));
  return meshes;
}

using Replay = ReplayResult (*)(std::span<const TriangleMesh>, const Trace&, std::string_view,
                                const ReplayOptions&);
constexpr std::pair<const char*, Replay> methods[] = {
    {"gjk", replay_closest_features<ClosestFeatures::gjk>},
    {"gjk coherent", replay_closest_features<ClosestFeatures::gjk_coherent>},
    {"v-clip", replay_closest_features<ClosestFeatures::v_clip>}};

bool holds(const closest_features::Polytope& p, const Vec3<double>& x) {
  return std::all_of(p.faces().begin(), p.faces().end(),
                     [&](const auto& face) { return p.above(face, x) <= 0; });
}

/// Of surfaces. That of solids is the same, but 0 where one is inside the other.
double brute_force(const TriangleMesh& a, const Pose& pose_a, const TriangleMesh& b,
                   const Pose& pose_b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < a.triangles.size(); ++s)
    for (std::size_t t = 0; t < b.triangles.size(); ++t) {
      Triangle one = a.corners(s), other = b.corners(t);
      for (auto& corner : one) corner = pose_a(corner);
      for (auto& corner : other) corner = pose_b(corner);
      least = std::min(least, distance(one, other).distance);
    }
  return least;
}

struct Seen {
  std::size_t touching = 0, apart = 0;
};

/// Both surfaces' sizes are about one, and no distance is off by more than some roundings of that.
Seen expect_brute_force(const std::vector<TriangleMesh>& meshes, const Trace& trace) {
  Seen seen;
  std::vector<std::vector<double>> answers;
  for (const auto& [name, replay] : methods)
    answers.push_back(replay(meshes, trace, "distance", {}).distances);
  const std::vector<closest_features::Polytope> polytopes(meshes.begin(), meshes.end());
  std::vector<Pose> poses(trace.objects);
  std::size_t cell = 0;
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(poses.size()))) {
      const std::size_t m_i = i % meshes.size(), m_j = j % meshes.size();
      const auto &a = polytopes[m_i], &b = polytopes[m_j];
      const closest_features::PosedPair posed(a, poses[i], b, poses[j]);
      const bool inside = holds(b, posed.across(0, 0)) || holds(a, posed.across(1, 0));
      const double least = inside ? 0 : brute_force(meshes[m_i], poses[i], meshes[m_j], poses[j]);
      for (std::size_t m = 0; m < answers.size(); ++m)
        EXPECT_NEAR(answers[m][cell], least, 1e-11 * least + 1e-14)
            << methods[m].first << ", frame " << frame << ": " << i << " and " << j;
      ++(least == 0 ? seen.touching : seen.apart), ++cell;
    }
  }
  return seen;
}

Trace walk_of(const std::vector<TriangleMesh>& meshes, double step, double degrees,
              std::size_t frames, double teleport) {
  std::vector<Extent> extents;
  for (const auto& mesh : meshes) extents.push_back(extent_of(mesh));
  RandomWalk walk;
  walk.objects = meshes.size();
  walk.frames = frames;
  walk.side = {3, Length::Unit::body};
  walk.step = {step, Length::Unit::body};
  walk.degrees = degrees;
  walk.teleport = teleport;
  auto array = walk.generate(extents, {});
  return {array.shape[0], array.shape[1], std::move(array.data)};
}

TEST(ClosestFeatures, AreThoseOfBruteForceAtRandom) {
  const auto meshes = convex_meshes();
  const Seen seen = expect_brute_force(meshes, walk_of(meshes, 1, 90, 30, 0.5));
  EXPECT_GT(seen.touching, 20u);
  EXPECT_GT(seen.apart, 200u);
}

TEST(ClosestFeatures, AreThoseOfBruteForceInMotion) {
  const auto meshes = convex_meshes();
  for (const auto& [step, degrees] : {std::pair(0.001, 0.1), {0.05, 5.0}}) {
    const Seen seen = expect_brute_force(meshes, walk_of(meshes, step, degrees, 40, 0.02));
    EXPECT_GT(seen.apart, 200u);
  }
}

/// Boxes and spheres on a lattice, turned by quarters: faces, edges and vertices parallel, flush,
/// touching and overlapping.
TEST(ClosestFeatures, BearParallelFacesAndContact) {
  std::vector<TriangleMesh> meshes;
  for (auto& [name, mesh] : named_meshes("box:12,box:108,icosphere:20", 0))
    meshes.push_back(std::move(mesh));
  Random random(7);
  Trace trace{60, meshes.size() * 2, {}};
  const double half = std::sqrt(0.5);
  const std::array<std::array<double, 4>, 5> turns = {
      {{1, 0, 0, 0}, {half, half, 0, 0}, {half, 0, half, 0}, {half, 0, 0, half}, {0, 1, 0, 0}}};
  for (std::size_t row = 0; row < trace.frames * trace.objects; ++row) {
    for (int d = 0; d < 3; ++d) trace.values.push_back(0.5 * static_cast<double>(random.below(9)));
    for (const double q : turns[random.below(turns.size())]) trace.values.push_back(q);
  }
  const Seen seen = expect_brute_force(meshes, trace);
  EXPECT_GT(seen.touching, 20u);
  EXPECT_GT(seen.apart, 200u);
}

TEST(ClosestFeatures, VClipSeldomGivesUp) {
  const auto meshes = convex_meshes();
  const Trace trace = walk_of(meshes, 0.01, 1, 300, 0.01);
  std::vector<closest_features::Polytope> polytopes(meshes.begin(), meshes.end());
  closest_features::Effort effort;
  std::vector<Pose> poses(trace.objects);
  std::uint64_t asked = 0, gave_up = 0;
  for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(trace.objects))) {
    closest_features::VClip walk;
    for (std::size_t frame = 0; frame < trace.frames; ++frame) {
      trace.poses(frame, poses);
      walk.nearest({polytopes[i], poses[i], polytopes[j], poses[j]}, effort), ++asked;
    }
    gave_up += walk.gave_up();
  }
  EXPECT_LE(gave_up * 200, asked) << gave_up << " of " << asked;
  EXPECT_LT(effort.steps, 4 * asked);
}

TEST(ClosestFeatures, CoherentQuestionsCostLittle) {
  const auto meshes = named_meshes("icosphere:2000", 0);
  const std::vector<TriangleMesh> two = {meshes[0].mesh, meshes[0].mesh};
  ReplayOptions options;
  options.count = Count::on;
  const Trace trace = walk_of(two, 0.0005, 0.05, 300, 0);
  const auto scan = methods[0].second(two, trace, "distance", options);
  const auto climb = methods[1].second(two, trace, "distance", options);
  const auto walk = methods[2].second(two, trace, "distance", options);
  EXPECT_LT(30 * climb.n_v, scan.n_v);
  EXPECT_LT(30 * walk.n_v, scan.n_v);
}

TEST(ClosestFeatures, RefuseWhatIsNotConvexOrClosed) {
  for (const char* name : {"torus", "star", "knot"})
    EXPECT_THROW(closest_features::Polytope(named_mesh(name, 200).mesh), Unusable) << name;
  TriangleMesh open = named_mesh("icosphere", 80).mesh;
  open.triangles.pop_back();
  EXPECT_THROW(closest_features::Polytope{open}, Unusable);
}

}  // namespace
}  // namespace bvlab
