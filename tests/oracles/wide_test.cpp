// SPDX-License-Identifier: BSD-3-Clause
/// Wide trees of boxes with slabs answer as brute force does: every query, fan-out and frame of
/// comparison.
#include "hierarchies/wide/slab_box_facing.hpp"
#include "tests/laws/frame_laws.hpp"
#include "tests/oracles/wide_scenes.hpp"

namespace bvlab {
namespace {

TEST(Wide, ScenesAreNeitherAllTouchingNorAllApart) {
  for (const auto& [scene, truth] : scenes_with_truth()) {
    const auto hits = std::count(truth.touching.begin(), truth.touching.end(), 1);
    EXPECT_GT(hits, 0) << scene.name;
    EXPECT_LT(hits, static_cast<std::ptrdiff_t>(truth.touching.size())) << scene.name;
  }
}

TEST(Wide, EveryQueryIsBruteForce) {
  expect_truth<SlabBox<float>, 16, RelativeFrame>();
  expect_truth<SlabBox<float>, 8, WorldFrame>();
}

TEST(Wide, EveryFanOutIsBruteForce) {
  expect_touching<SlabBox<float>, 2, RelativeFrame>();
  expect_touching<SlabBox<float>, 4, RelativeFrame>();
  expect_touching<SlabBox<float>, 8, RelativeFrame>();
}

TEST(Wide, LawsHoldInBothFrames) {
  expect_frame_laws<SlabBox<float>, 8, RelativeFrame>();
  expect_frame_laws<SlabBox<float>, 4, RelativeFrame>();
  expect_frame_laws<SlabBox<float>, 8, WorldFrame>();
}

TEST(Wide, RememberingIsBruteForce) {
  expect_truth_in_motion<SlabBox<float>, 16, RelativeFrame, WideMargins>();
  expect_truth_in_motion<SlabBox<float>, 8, WorldFrame, WideMargins>();
  expect_truth_in_motion<SlabBox<float>, 8, RelativeFrame, Forgetful>();
}

double exact_support(const TriangleMesh& mesh, const Vec3<double>& centre, const Vec3<double>& d) {
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) most = std::max(most, d.dot(mesh.vertices[v] - centre));
  return most;
}

/// What is between samples is never below the mesh, and for a round one hardly above.
TEST(Wide, SupportsAreBounds) {
  const TriangleMesh mesh = formula_mesh("icosphere", 1280);
  const MeshBall ball(mesh);
  const SupportMap map(mesh, ball.centre);
  constexpr int row = SupportMap::row;
  ASSERT_EQ(map.table().size(), static_cast<std::size_t>(SupportMap::samples));
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i + 1 < row; ++i)
      for (int j = 0; j + 1 < row; ++j) {
        const auto* sample = &map.table()[static_cast<std::size_t>((face * row + i) * row + j)];
        const double between = (double(sample[0].height) + sample[1].height + sample[row].height +
                                sample[row + 1].height) /
                               4;
        Vec3<double> d;
        d[face / 2] = face % 2 ? -1 : 1;
        d[(face / 2 + 1) % 3] = 2 * (i + 0.5) / SupportMap::cells - 1;
        d[(face / 2 + 2) % 3] = 2 * (j + 0.5) / SupportMap::cells - 1;
        const double exact = exact_support(mesh, ball.centre, d);
        EXPECT_GE(between, exact);
        EXPECT_LT(between, exact + 0.02 * d.norm() * ball.radius);
      }
}

/// Directions tell most pairs apart that are, none that touches, and no distance is overrated.
TEST(Wide, DirectionsTellApart) {
  using Directions = SeparatingDirections;
  for (const auto& [scene, truth] : scenes_with_truth()) {
    const auto pairs = all_object_pairs(static_cast<std::uint32_t>(scene.frames[0].size()));
    Directions directions;
    directions.resize(scene.frames[0].size());
    std::vector<SupportMap> maps;
    std::vector<std::int32_t> numbers;
    std::vector<MeshBall> balls;
    for (const auto& mesh : scene.meshes) {
      balls.emplace_back(mesh);
      maps.emplace_back(mesh, balls.back().centre);
      numbers.push_back(directions.add(maps.back()));
    }
    std::size_t told = 0, apart = 0;
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      const Frame& frame = scene.frames[f];
      for (std::size_t i = 0; i < frame.size(); ++i) {
        const std::size_t m = i % balls.size();
        double reach = 0;
        for (const auto& v : scene.meshes[m].vertices) reach = std::max(reach, v.norm());
        directions.stand(i, numbers[m], frame[i].rotation,
                         frame[i](balls[m].centre) - frame[0].translation, balls[m].radius,
                         OrthonormalPose(frame[i], reach).noise);
      }
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        const auto lanes = directions.pairs(Directions::Indices(static_cast<int>(pairs[p].i)),
                                            Directions::Indices(static_cast<int>(pairs[p].j)));
        auto d = Directions::normalized(lanes.between);
        const auto gap = directions.gaps(lanes, d, 1 + static_cast<int>(f % 8));
        const double distance = truth.distances[f * pairs.size() + p];
        for (std::size_t lane = 0; lane < gap.size(); ++lane)
          EXPECT_LE(static_cast<double>(gap[lane]), distance) << scene.name;
        if (!(directions.balls_meet(lanes) & 1)) EXPECT_GT(distance, 0) << scene.name;
        apart += distance > 0, told += gap[0] > 0;
      }
    }
    EXPECT_LE(told, apart);
    if (std::string_view(scene.name) == "sparse") EXPECT_GT(4 * told, 3 * apart);
  }
}

bool surfaces_touch(const TriangleMesh& mesh, const Frame& frame) {
  std::array<std::vector<Triangle>, 2> world;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      world[i].push_back(mesh.corners(t));
      for (auto& corner : world[i].back()) corner = frame[i](corner);
    }
  for (const auto& a : world[0])
    for (const auto& b : world[1])
      if (intersect(a, b)) return true;
  return false;
}

/// Two bodies deep in each other go on to touch without a look, and stop when they have come apart.
TEST(Wide, TouchingLasts) {
  const TriangleMesh mesh = formula_mesh("icosphere", 320);
  const WideHierarchy<SlabBox<float>, 16> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  const std::vector<WideShape<SlabBox<float>, 16>> shapes(2, {&mesh, &hierarchy});
  WidePairs<SlabBox<float>, 16, RelativeFrame, WideMargins> engine(shapes, all_object_pairs(2));
  constexpr std::size_t frames = 4000;
  std::size_t looked_at = 0, touching = 0;
  for (std::size_t f = 0; f < frames; ++f) {
    Frame frame(2);
    frame[1].translation = Vec3<double>(1.2 + 0.0004 * static_cast<double>(f), 0.31, 0.17);
    Counting counter;
    bool found = false;
    engine.frame(
        frame, counter, [](std::size_t) { return Touching(); },
        [&](std::size_t, const Touching& query) { found = query.touching(); });
    if (f % 20 == 0) EXPECT_EQ(found, surfaces_touch(mesh, frame)) << f;
    touching += found, looked_at += found && counter.n_v + counter.n_p > 0;
  }
  EXPECT_GT(touching, 1000u);
  EXPECT_LT(touching, frames);
  EXPECT_LT(3 * looked_at, touching);
}

/// What rests, moves along together or is far from the rest is not tested again.
TEST(Wide, RestIsNotTested) {
  for (const auto& [scene, truth] : scenes_with_truth()) {
    std::vector<WideHierarchy<SlabBox<float>, 8>> hierarchies;
    for (const auto& mesh : scene.meshes)
      hierarchies.emplace_back(mesh, builds::BottomUpLocal::topology(mesh, 1));
    std::vector<WideShape<SlabBox<float>, 8>> shapes;
    for (std::size_t i = 0; i < scene.frames[0].size(); ++i) {
      const std::size_t k = i % scene.meshes.size();
      shapes.push_back({&scene.meshes[k], &hierarchies[k]});
    }
    WidePairs<SlabBox<float>, 8, RelativeFrame, WideMargins> engine(
        shapes, all_object_pairs(static_cast<std::uint32_t>(shapes.size())));
    std::vector<std::uint8_t> found(engine.pairs().size());
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      std::uint64_t tested = 0;
      for (int again = 0; again < 3; ++again) {
        Counting counter;
        engine.frame(
            scene.frames[f], counter, [](std::size_t) { return Touching(); },
            [&](std::size_t p, const Touching& query) { found[p] = query.touching(); });
        for (std::size_t p = 0; p < found.size(); ++p)
          EXPECT_EQ(found[p], truth.touching[f * found.size() + p]) << scene.name;
        if (again == 0) tested = counter.n_v;
        EXPECT_EQ(counter.n_v, again == 0 ? tested : 0) << scene.name;
      }
      EXPECT_GT(tested, 0u) << scene.name;
    }
  }
}

}  // namespace
}  // namespace bvlab
