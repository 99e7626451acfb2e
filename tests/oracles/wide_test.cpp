// SPDX-License-Identifier: BSD-3-Clause
/// Wide trees of boxes with slabs answer as brute force does: every query and fan-out.
#include <random>

#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "tests/laws/frame_laws.hpp"
#include "tests/oracles/wide_scenes.hpp"

namespace bvlab {
namespace {

/// A query that culls boxes farther apart than some distance. Wide trees never call its `culls`.
struct Within : Touching {
  static constexpr bool culls_disjoint = false;
};
static_assert(!for_wide_trees<Within>());
static_assert(for_wide_trees<Touching>() && for_wide_trees<Contacts>() &&
              for_wide_trees<Distance>());

TEST(Wide, ScenesAreNeitherAllTouchingNorAllApart) {
  for (const auto& [scene, truth] : scenes_with_truth()) {
    const auto hits = std::count(truth.touching.begin(), truth.touching.end(), 1);
    EXPECT_GT(hits, 0) << scene.name;
    EXPECT_LT(hits, static_cast<std::ptrdiff_t>(truth.touching.size())) << scene.name;
  }
}

TEST(Wide, EveryQueryIsBruteForce) { expect_truth<SlabBox<float>, 16>(); }

TEST(Wide, EveryFanOutIsBruteForce) {
  expect_touching<SlabBox<float>, 2>();
  expect_touching<SlabBox<float>, 4>();
  expect_touching<SlabBox<float>, 8>();
}

TEST(Wide, LawsHoldInTheOtherFrame) {
  expect_frame_laws<SlabBox<float>, 8>();
  expect_frame_laws<SlabBox<float>, 4>();
}

TEST(Wide, RememberingIsBruteForce) {
  expect_truth_in_motion<SlabBox<float>, 16, WideMargins>();
  expect_truth_in_motion<SlabBox<float>, 8, NoMemory>();
}

TEST(Wide, ListsAreBruteForce) {
  expect_truth_in_motion<SlabBox<float>, 16, ListMemory>();
  expect_truth_in_motion<SlabBox<float>, 16, ListMemory>(raised_lists());
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
  const MeshSphere ball(mesh);
  const SupportMap map(mesh, ball.centre);
  constexpr int row = SupportMap::row;
  ASSERT_EQ(map.table().size(), static_cast<std::size_t>(SupportMap::samples));
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i + 1 < row; ++i)
      for (int j = 0; j + 1 < row; ++j) {
        const auto* sample =
            &map.table()[(static_cast<std::size_t>(face) * row + static_cast<std::size_t>(i)) *
                             row +
                         static_cast<std::size_t>(j)];
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
    std::vector<MeshSphere> balls;
    for (const auto& mesh : scene.meshes) {
      balls.emplace_back(mesh);
      maps.emplace_back(mesh, balls.back().centre);
      numbers.push_back(directions.add(maps.back()));
    }
    std::size_t told = 0, apart = 0;
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      const PosesOfFrame& frame = scene.frames[f];
      for (std::size_t i = 0; i < frame.size(); ++i) {
        const std::size_t m = i % balls.size();
        double reach = 0;
        for (const auto& v : scene.meshes[m].vertices) reach = std::max(reach, v.norm());
        directions.set_pose(i, numbers[m], frame[i].rotation,
                            frame[i](balls[m].centre) - frame[0].translation, balls[m].radius,
                            OrthonormalPose(frame[i], reach).error_bound);
      }
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        const auto lanes = directions.pairs(Directions::Indices(static_cast<int>(pairs[p].i)),
                                            Directions::Indices(static_cast<int>(pairs[p].j)));
        auto d = Directions::normalized(lanes.between);
        const auto gap = directions.gaps(lanes, d, 1 + static_cast<int>(f % 8));
        const double distance = truth.distances[f * pairs.size() + p];
        for (std::size_t lane = 0; lane < gap.size(); ++lane)
          EXPECT_LE(static_cast<double>(gap[lane]), distance) << scene.name;
        if (!(directions.spheres_meet(lanes) & 1)) {
          EXPECT_GT(distance, 0) << scene.name;
        }
        apart += distance > 0, told += gap[0] > 0;
      }
    }
    EXPECT_LE(told, apart);
    if (std::string_view(scene.name) == "sparse") {
      EXPECT_GT(4 * told, 3 * apart);
    }
  }
}

/// Some points of a body, wherever it stands.
struct SomePoints : MovingBody {
  std::vector<Vec3<double>> points;
  double reach = 0;

  explicit SomePoints(std::vector<Vec3<double>> of_mesh)
      : MovingBody(HierarchyExtent{Vec3<double>::Zero(), reach_of(of_mesh), reach_of(of_mesh), 0}),
        points(std::move(of_mesh)),
        reach(reach_of(points)) {}

  static double reach_of(const std::vector<Vec3<double>>& points) {
    double reach = 0;
    for (const auto& point : points) reach = std::max(reach, stable_norm(point));
    return reach * (1 + 8 * unit_roundoff<double>);
  }
  void place(const Pose& pose) { MovingBody::set_pose(pose, Vec3<double>::Zero()); }
  std::vector<Vec3<double>> world() const {
    std::vector<Vec3<double>> world;
    world.reserve(points.size());
    for (const auto& point : points) world.push_back(pose()(point));
    return world;
  }
  /// From the point of this that is nearest to the other to there.
  Vec3<double> to(const SomePoints& other) const {
    Vec3<double> least = Vec3<double>::Constant(std::numeric_limits<double>::infinity());
    for (const auto& a : world())
      for (const auto& b : other.world())
        if (stable_norm(b - a) < stable_norm(least)) least = b - a;
    return least;
  }
  OrthonormalPose orthonormal() const { return OrthonormalPose(pose(), reach); }
};

/// What a front promises is never more than the distance, whatever bodies do; where it has gone
/// down by no more than they moved, it is of use.
TEST(Wide, FrontsPromiseNoMoreThanThereIs) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3<double>(number(random), number(random), number(random)); };
  const auto turned = [&](const Pose& pose, double angle) {
    const Vec3<double> axis = 0.5 * angle * vector();
    const Mat3<double> step =
        pose_from(Vec3<double>::Zero(), 1, axis[0], axis[1], axis[2])->rotation;
    return Pose{step * pose.rotation, pose.translation};
  };
  std::size_t useful = 0, asked = 0;
  for (int round = 0; round < 3000; ++round) {
    const double scale = std::exp2(std::array{0, -60, 60, -100, 3}[round % 5]);
    const double far = round % 4 == 0 ? 1e6 * scale : scale;
    const bool askew = round % 7 == 0;  // no rotation to the last digit
    std::array<std::vector<Vec3<double>>, 2> points;
    std::array<Vec3<double>, 2> middle;
    const double size = std::exp2(-3 + 3 * number(random));
    for (std::size_t side = 0; side < 2; ++side) {
      middle[side] = scale * vector();
      for (int k = 0; k < 8; ++k) points[side].push_back(middle[side] + scale * size * vector());
      points[side].push_back(scale * 2 * vector());  // so that the ball is not all of the body
    }
    std::array<SomePoints, 2> body{SomePoints(points[0]), SomePoints(points[1])};
    const Vec3<double> away = far * vector();
    std::array<Pose, 2> pose;
    for (std::size_t side = 0; side < 2; ++side) {
      pose[side] = turned(Pose(), 10);
      // The balls near each other.
      pose[side].translation = away - pose[side].rotation * middle[side] +
                               (side ? 1.0 : -1.0) * scale * size *
                                   Vec3<double>(std::array{0.9, 1.2, 2.0}[round / 3 % 3], 0, 0);
      if (askew) pose[side].rotation(0, 1) += 1e-9;
      body[side].place(pose[side]);
    }
    const auto turn = [&] { return body[0].rotation_bound() + body[1].rotation_bound(); };
    const auto between = [&] {
      std::array<CornerTransform, 2> corners;
      for (std::size_t side = 0; side < 2; ++side)
        corners[side].begin(RelativePose(body[side].orthonormal(), body[1 - side].orthonormal()),
                            body[side].reach, body[1 - side].reach);
      return corners;
    };
    // Only the balls' points are promised to be apart.
    std::array<SomePoints, 2> ball = body;
    for (auto& each : ball) each.points.pop_back();
    turn();
    const std::size_t side = static_cast<std::size_t>(round / 2 % 2);
    NodeSphere around{};
    double radius = 0;
    for (int i = 0; i < 3; ++i) around.centre[i] = static_cast<float>(middle[side][i]);
    for (const auto& point : ball[side].points)
      radius = std::max(radius, stable_norm(point - Vec3<double>(around.centre[0], around.centre[1],
                                                                 around.centre[2])));
    around.radius = rounded_up<float>(radius * (1 + 1e-12));
    const double apart = stable_norm(ball[0].to(ball[1]));
    const float gap = next_down(static_cast<float>(apart));
    MeasuredGaps gaps;
    gaps.add(), gaps.add();
    gaps.set(1, gap, reference_sphere_of(around, side, between()), turn());
    MeasuredGaps many;  // measured for a register of entries: the same
    many.add(), many.add();
    many.announce(1, gap, MeasuredGaps::Of::volumes);
    NodeSphere larger{};
    larger.radius = std::numeric_limits<float>::infinity();
    many.measure(0, between(), turn(), 0,
                 [&](std::size_t of, int) { return of == side ? &around : &larger; });
    const double speed = std::exp2(-4 + 4 * number(random));
    for (int frame = 0; frame < 6; ++frame) {
      const Vec3<double> nearest = ball[0].to(ball[1]);
      for (std::size_t k = 0; k < 2; ++k) {
        if (round % 3 == 0) {  // straight to the other
          pose[k].translation += (k ? -0.07 : 0.07) * nearest;
        } else if (round % 3 == 1) {  // on the spot
          const Vec3<double> at = pose[k](middle[k]);
          pose[k] = turned(pose[k], 8);
          pose[k].translation += at - pose[k](middle[k]);
        } else {
          pose[k] = turned(pose[k], speed * size);
          pose[k].translation += 0.1 * speed * size * scale * vector();
        }
        body[k].place(pose[k]), ball[k].place(pose[k]);
        body[k].rotation_bound();
      }
      const auto remaining = gaps.remaining(0, between()[0], turn());
      EXPECT_FALSE(remaining[0] > 0);  // never measured
      EXPECT_EQ(many.remaining(0, between()[0], turn())[1], remaining[1]) << round;
      const double distance = stable_norm(ball[0].to(ball[1]));
      EXPECT_FALSE(static_cast<double>(remaining[1]) > distance)
          << round << " frame " << frame << ": " << remaining[1] << " of " << distance;
      asked += far == scale && scale > 1e-25 && distance > 0.9 * apart, useful += remaining[1] > 0;
    }
  }
  EXPECT_GT(3 * useful, asked);
}

bool surfaces_touch(const TriangleMesh& mesh, const PosesOfFrame& frame) {
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

/// What an engine of two bodies answers.
bool touch(AllPairsOf<WidePairs<SlabBox<float>, 16, WideMargins>>& engine,
           const PosesOfFrame& frame, Counting& counter) {
  bool found = false;
  engine.frame(
      frame, counter, [](std::size_t) { return Touching(); },
      [&](std::size_t, const Touching& query) { found = query.touching(); });
  return found;
}

/// Two bodies deep in each other go on to touch without a look, and stop when they have come apart.
TEST(Wide, TouchingLasts) {
  const TriangleMesh mesh = formula_mesh("icosphere", 320);
  const WideHierarchy<SlabBox<float>, 16> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  const std::vector<WideShape<SlabBox<float>, 16>> shapes(2, {&mesh, &hierarchy});
  AllPairsOf engine(WidePairs<SlabBox<float>, 16, WideMargins>(shapes), all_object_pairs(2));
  constexpr std::size_t frames = 4000;
  std::size_t looked_at = 0, touching = 0;
  for (std::size_t f = 0; f < frames; ++f) {
    PosesOfFrame frame(2);
    frame[1].translation = Vec3<double>(1.2 + 0.0004 * static_cast<double>(f), 0.31, 0.17);
    Counting counter;
    const bool found = touch(engine, frame, counter);
    if (f % 20 == 0) {
      EXPECT_EQ(found, surfaces_touch(mesh, frame)) << f;
    }
    touching += found, looked_at += found && counter.n_v + counter.n_p > 0;
  }
  EXPECT_GT(touching, 1000u);
  EXPECT_LT(touching, frames);
  EXPECT_LT(3 * looked_at, touching);
}

/// Boxes that share a plane and slide along it: no test in float is certain that they touch. The
/// triangles that met last are tested exactly, and nothing is traversed until they have parted.
TEST(Wide, TouchingInAPlaneLasts) {
  const TriangleMesh mesh = formula_mesh("box", 12);
  const WideHierarchy<SlabBox<float>, 16> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  const std::vector<WideShape<SlabBox<float>, 16>> shapes(2, {&mesh, &hierarchy});
  AllPairsOf engine(WidePairs<SlabBox<float>, 16, WideMargins>(shapes), all_object_pairs(2));
  double side = 0;
  for (const auto& vertex : mesh.vertices) side = std::max(side, 2 * vertex[0]);
  std::size_t traversed = 0, touching = 0;
  for (int f = 0; f < 600; ++f) {
    PosesOfFrame frame(2);
    frame[1].translation = Vec3<double>(side, f * 0x1p-9, f * 0x1p-10);
    Counting counter;
    const bool found = touch(engine, frame, counter);
    EXPECT_EQ(found, surfaces_touch(mesh, frame)) << f;
    touching += found, traversed += found && counter.n_p != 1;
  }
  EXPECT_GT(touching, 300u);
  EXPECT_LT(10 * traversed, touching);
}

/// Bodies that jump in every frame, then hardly move, then jump again, one time over.
std::vector<PosesOfFrame> jumping_and_slow(std::size_t bodies) {
  std::mt19937 random(5);
  std::vector<PosesOfFrame> frames;
  for (int f = 0; f < 30; ++f) frames.push_back(random_frame(random, bodies, 1.2, 0, {0, 0, 0}));
  for (int f = 0; f < 30; ++f) {
    frames.push_back(frames.back());
    for (auto& pose : frames.back()) pose.translation[0] += 1e-5;
  }
  for (int f = 0; f < 90; ++f) frames.push_back(random_frame(random, bodies, 1.2, 0, {0, 0, 0}));
  return frames;
}

/// Plays these frames and expects of margins the answers from the roots in every frame.
template <class Query, class MakeQuery, class AnswerOf>
void expect_answers_from_the_roots(const MakeQuery& make_query, const AnswerOf& answer_of) {
  const TriangleMesh mesh = formula_mesh("star", 120);
  const WideHierarchy<SlabBox<float>, 16> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  const std::vector<WideShape<SlabBox<float>, 16>> shapes(8, {&mesh, &hierarchy});
  AllPairsOf margins(WidePairs<SlabBox<float>, 16, WideMargins>(shapes), all_object_pairs(8));
  AllPairsOf from_roots(WidePairs<SlabBox<float>, 16>(shapes), all_object_pairs(8));
  const auto frames = jumping_and_slow(8);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::vector<double> expected(margins.pairs().size(), -1), found = expected;
    Counting counter;
    from_roots.frame(frames[f], counter, make_query,
                     [&](std::size_t p, const Query& query) { expected[p] = answer_of(query); });
    margins.frame(frames[f], counter, make_query,
                  [&](std::size_t p, const Query& query) { found[p] = answer_of(query); });
    // Distances that differ by less than 2^-45 count as equal (distance.hpp): which of two such
    // pairs of triangles is found depends on the order of tests.
    for (std::size_t p = 0; p < found.size(); ++p)
      EXPECT_NEAR(found[p], expected[p], 0x1p-44 * expected[p]) << f << ' ' << p;
  }
}

TEST(Wide, MarginsOfBodiesThatJump) {
  expect_answers_from_the_roots<Touching>(
      [](std::size_t) { return Touching(); },
      [](const Touching& query) { return query.touching() ? 1.0 : 0.0; });
  expect_answers_from_the_roots<Distance>([](std::size_t) { return Distance(); },
                                          [](const Distance& query) { return query.distance(); });
}

/// The answers of all pairs in a world, of which each frame queries those with a body that moved.
template <class Pairs>
class SlotAnswers {
 public:
  SlotAnswers(std::span<const WideShape<SlabBox<float>, 16>> shapes,
              const std::vector<ObjectPair>& pairs)
      : world_(shapes), pairs_(pairs), touching_(pairs.size()) {
    for (std::uint32_t slot = 0; slot < pairs.size(); ++slot) world_.put(slot, pairs[slot]);
  }
  const std::vector<std::uint8_t>& frame(const std::vector<std::uint32_t>& movers,
                                         const PosesOfFrame& poses) {
    world_.template begin<Touching>(movers, poses, origin_, threads_);
    for (const auto i : movers) world_.set_pose(i);
    std::vector<std::uint32_t> due;
    for (std::uint32_t slot = 0; slot < pairs_.size(); ++slot)
      for (const auto i : movers)
        if (pairs_[slot].i == i || pairs_[slot].j == i) {
          due.push_back(slot);
          break;
        }
    Counting counter;
    world_.run(
        due, 0, counter, [](std::uint32_t, const ObjectPair&) { return Touching(); },
        [&](std::uint32_t slot, const ObjectPair&, const Touching& query) {
          touching_[slot] = query.touching();
        });
    return touching_;
  }

 private:
  Pairs world_;
  std::vector<ObjectPair> pairs_;
  std::vector<std::uint8_t> touching_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  Threads threads_{1};
};

/// In a world bodies jump, move a little and rest, by turns. Answers are those from the roots in
/// every frame.
TEST(Wide, MarginsInWorlds) {
  const TriangleMesh mesh = formula_mesh("star", 120);
  const WideHierarchy<SlabBox<float>, 16> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  const std::vector<WideShape<SlabBox<float>, 16>> shapes(6, {&mesh, &hierarchy});
  const auto pairs = all_object_pairs(6);
  SlotAnswers<WidePairs<SlabBox<float>, 16, WideMargins>> margins(shapes, pairs);
  SlotAnswers<WidePairs<SlabBox<float>, 16>> from_roots(shapes, pairs);
  std::mt19937 random(8);
  PosesOfFrame poses = random_frame(random, 6, 1.2, 0, {0, 0, 0});
  for (int f = 0; f < 3000; ++f) {
    // All are placed first. Then bodies jump for a while, or move a little, most of them or few.
    const bool jumps = f / 40 % 3 != 2, few = f / 25 % 2 == 1;
    std::vector<std::uint32_t> movers;
    for (std::uint32_t i = 0; i < 6; ++i)
      if (f == 0 || random() % (few ? 5 : 2) == 0) movers.push_back(i);
    const PosesOfFrame next = random_frame(random, 6, 1.2, 0, {0, 0, 0});
    for (const auto i : movers)
      if (jumps)
        poses[i] = next[i];
      else
        poses[i].translation[0] += 1e-3;
    ASSERT_EQ(margins.frame(movers, poses), from_roots.frame(movers, poses)) << f;
  }
}

/// What rests, moves along together or is far from the rest is not tested again.
TEST(Wide, RestIsNotTested) {
  for (const auto& [scene, truth] : scenes_with_truth()) {
    std::vector<WideHierarchy<SlabBox<float>, 8>> hierarchies;
    hierarchies.reserve(scene.meshes.size());
    for (const auto& mesh : scene.meshes)
      hierarchies.emplace_back(mesh, builds::BottomUpLocal::topology(mesh, 1));
    std::vector<WideShape<SlabBox<float>, 8>> shapes;
    for (std::size_t i = 0; i < scene.frames[0].size(); ++i) {
      const std::size_t k = i % scene.meshes.size();
      shapes.push_back({&scene.meshes[k], &hierarchies[k]});
    }
    AllPairsOf engine(WidePairs<SlabBox<float>, 8, WideMargins>(shapes),
                      all_object_pairs(static_cast<std::uint32_t>(shapes.size())));
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
        if (again == 0) tested = counter.n_b + counter.n_v;
        EXPECT_EQ(counter.n_b + counter.n_v, again == 0 ? tested : 0) << scene.name;
      }
      EXPECT_GT(tested, 0u) << scene.name;
    }
  }
}

}  // namespace
}  // namespace bvlab
