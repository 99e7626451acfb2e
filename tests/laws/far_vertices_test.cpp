// SPDX-License-Identifier: BSD-3-Clause
/// Meshes in survey coordinates: their origins, the bound on their poses, and what is recommended
/// for them. For the law of all volumes see far_laws.hpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "experiments/replay/configurations.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/recommended_distances.hpp"
#include "traversal/recommended_for.hpp"
#include "traversal/world.hpp"

namespace bvlab {
namespace {

const Vec3<double> survey(388096, 5948996, 35);

TriangleMesh shifted(TriangleMesh mesh, const Vec3<double>& by) {
  for (auto& v : mesh.vertices) v += by;
  return mesh;
}

TEST(LocalMesh, KeepsMeshesThatAreNearZero) {
  const TriangleMesh box = formula_mesh("box", 12);
  for (const Vec3<double>& at : {Vec3<double>(0, 0, 0), Vec3<double>(15, -15, 3)}) {
    const TriangleMesh mesh = shifted(box, at);
    const LocalMesh local(mesh);
    EXPECT_EQ(local.origin(), Vec3<double>(0, 0, 0));
    EXPECT_EQ(&local.mesh(), &mesh);
  }
}

TEST(LocalMesh, ShiftedByItsGridBecomesItselfAgain) {
  TriangleMesh mesh = formula_mesh("star", 100);
  for (auto& v : mesh.vertices)
    v = v.unaryExpr([](double x) { return std::nearbyint(1024 * x) / 1024; });
  for (const int exponent : {8, 20, 41}) {
    const Vec3<double> by = std::ldexp(1.0, exponent) * Vec3<double>(-1, 0.5, 0);
    const TriangleMesh far = shifted(mesh, by);
    const LocalMesh local(far);
    EXPECT_EQ(local.origin(), by);
    EXPECT_EQ(local.mesh().vertices, mesh.vertices);
    EXPECT_EQ(local.mesh().triangles, mesh.triangles);
  }
}

/// A vertex at 0 that no triangle uses, as converters leave it in.
TEST(LocalMesh, DoesNotSeeVerticesOfNoTriangle) {
  TriangleMesh mesh = shifted(formula_mesh("box", 12), survey);
  const Vec3<double> origin = LocalMesh(mesh).origin();
  EXPECT_LT((origin - survey).norm(), 8);
  mesh.vertices.emplace_back(0, 0, 0);
  EXPECT_EQ(LocalMesh(mesh).origin(), origin);
  EXPECT_LT(RecommendedDistances::hierarchy(mesh).reach(), 8);
  EXPECT_LT(Recommended::hierarchy(mesh).reach(), 8);
  TriangleMesh near = formula_mesh("box", 12);
  near.vertices.push_back(survey);
  EXPECT_LT(Recommended::hierarchy(near).reach(), 8);
}

TEST(LocalMesh, OfAnySize) {
  for (const double size : {5e-324, 1e-300, 1e300}) {
    TriangleMesh mesh = formula_mesh("box", 12);
    for (auto& v : mesh.vertices) v = v * size + Vec3<double>::Constant(1e308);
    const LocalMesh local(mesh);
    EXPECT_TRUE(local.origin().allFinite()) << size;
    for (const auto& v : local.mesh().vertices) EXPECT_TRUE(v.allFinite()) << size;
  }
}

/// Where Pose puts a vertex is within the bound of where LocalPose puts the local one: turned by
/// rotations, by exact ones, and by matrices that are none.
TEST(LocalPose, IsWithinItsBound) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&](double size) -> Vec3<double> {
    const double x = unit(random), y = unit(random), z = unit(random);
    return size * Vec3<double>(x, y, z);
  };
  double closest = 1;
  for (int trial = 0; trial < 20000; ++trial) {
    const double away = std::pow(10, 2 + 6 * (1 + unit(random)));
    const Vec3<double> origin = vector(away).unaryExpr([](double x) { return std::nearbyint(x); });
    Pose pose = *pose_from(vector(1), unit(random), unit(random), unit(random), unit(random));
    if (trial % 4 == 1)
      pose.rotation += 0.1 * Mat3<double>::NullaryExpr([&] { return unit(random); });
    if (trial % 4 == 2) pose.rotation << 0, -1, 0, 0, 0, 1, 1, 0, 0;
    if (trial % 8 == 2) pose.translation.setZero();
    if (trial % 3 > 0) pose.translation -= pose.rotation * origin;
    Vec3<double> about = vector(10);
    if (trial % 2) about += pose(origin);
    if (trial % 8 == 2) about.setZero();
    const double reach = 2;
    const LocalPose local(pose, origin, reach, about);
    const Vec3<double> v = origin + vector(1), l = v - origin;
    const Vec3<double> w = pose(v);
    DoubleDouble squared = 0.0;
    for (int i = 0; i < 3; ++i) {  // w - about - (R l + t'), with twice the digits
      DoubleDouble off = DoubleDouble(w[i]) - DoubleDouble(about[i]);
      off = off - DoubleDouble(local.pose.translation[i]);
      for (int j = 0; j < 3; ++j)
        off = off - DoubleDouble::product(local.pose.rotation(i, j), l[j]);
      squared = squared + off * off;
    }
    const double off = std::sqrt(squared.high);
    ASSERT_LE(off, local.error) << trial;
    if (local.error > 0) closest = std::min(closest, 1 - off / local.error);
    if (trial % 8 == 2 && trial % 3 == 0) {
      EXPECT_LT(local.error, 1e-14) << "exact, however far";
    }
  }
  EXPECT_LT(closest, 0.9) << "not a tenth of the bound is ever used";
  Pose pose;
  pose.translation.setConstant(1e308);
  EXPECT_EQ(LocalPose(pose, Vec3<double>::Constant(1e308), 1).error,
            std::numeric_limits<double>::infinity());
}

/// The box holds every vertex as Pose moves it, and is hardly larger than near 0.
TEST(FarVertices, BoxesHoldThem) {
  const TriangleMesh mesh = formula_mesh("star", 100), far = shifted(mesh, survey);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    Pose pose = *pose_from(Vec3<double>::Zero(), unit(random), unit(random), unit(random), 1);
    if (trial % 2) pose.translation = -(pose.rotation * survey);
    const RotatedMeshBox box_of(far);
    const Vec3<double> origin = box_of.mesh_origin(pose);
    const Box<float> box = box_of(pose, origin),
                     usual = RotatedMeshBox(mesh)(Pose{pose.rotation, Vec3<double>::Zero()},
                                                  Vec3<double>::Zero());
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.hi[axis] - box.lo[axis], 1.2 * (usual.hi[axis] - usual.lo[axis]));
      for (const auto& v : far.vertices) {
        const long double at = static_cast<long double>(pose(v)[axis]) - origin[axis];
        ASSERT_GE(at, static_cast<long double>(box.lo[axis]));
        ASSERT_LE(at, static_cast<long double>(box.hi[axis]));
      }
    }
  }
}

/// A sphere without symmetries: of a symmetric one the rounding of vertices decides between splits
/// of equal cost, and trees differ by what is not looked at here.
TriangleMesh uneven_sphere() {
  TriangleMesh mesh = formula_mesh("icosphere", 500);
  for (auto& v : mesh.vertices)
    v += 0.02 * Vec3<double>(v[1] * v[1] - v[1] * v[2], v[2] * v[2], v[0] * v[1]);
  return mesh;
}

/// Sixty parts with their places in their vertices; neighbours a hundredth apart, or crossing.
struct Parts {
  std::vector<TriangleMesh> meshes;
  std::vector<Pose> poses = std::vector<Pose>(60);

  explicit Parts(const Vec3<double>& at) {
    for (int i = 0; i < 60; ++i) {
      const int row = i / 8, column = i % 8;
      const Vec3<double> here(2.01 * column - (i % 7 ? 0 : 0.08), 2.01 * row, 0);
      meshes.push_back(shifted(uneven_sphere(), at + here));
    }
  }
};

/// Vertices are rounded otherwise there, so that trees of symmetric meshes split ties otherwise.
void expect_no_more(std::uint64_t tests, std::uint64_t usual) { EXPECT_LE(tests, 2 * usual + 20); }

/// One frame, counted.
ReplayResult played(const Parts& parts, const Variant& variant) {
  Trace trace{1, parts.poses.size(), {}};
  for (std::size_t i = 0; i < parts.poses.size(); ++i)
    for (const double number : {0, 0, 0, 1, 0, 0, 0}) trace.values.push_back(number);
  ReplayOptions options;
  options.count = Count::on;
  return replay(parts.meshes, trace, variant, options);
}

TEST(FarVertices, EveryRecommendedConfigurationIsAsNearZero) {
  const Parts near(Vec3<double>::Zero()), far(survey);
  for_each_candidate([&]<class Best>(const RecommendedCandidate<Best>& candidate) {
    const auto usual = played(near, variant_of<Best>({})), now = played(far, variant_of<Best>({}));
    EXPECT_EQ(now.touching, usual.touching) << candidate.name;
    EXPECT_GE(usual.hits, 5u) << candidate.name;
    expect_no_more(now.n_p, usual.n_p), expect_no_more(now.n_v, usual.n_v);
  });
}

TEST(FarVertices, DistancesTakeNoMoreTests) {
  Variant variant;
  variant.query = Distance::name;
  variant = configured(variant, "recommended");
  const auto usual = played(Parts(Vec3<double>::Zero()), variant),
             now = played(Parts(survey), variant);
  // Vertices are a millionth of a millionth of the survey coordinates elsewhere, at most.
  for (std::size_t p = 0; p < usual.distances.size(); ++p)
    EXPECT_NEAR(now.distances[p], usual.distances[p], 1e-8);
  EXPECT_EQ(usual.distances.size(), 1770u);
  expect_no_more(now.n_p, usual.n_p), expect_no_more(now.n_v, usual.n_v);
}

TEST(FarVertices, WorldsFindNoMorePairs) {
  const auto play = [](const Parts& parts) {
    std::array<std::uint64_t, 4> found{};  // near, touching, N_v, N_p
    Counting counter;
    std::vector<Recommended::Hierarchy> trees;
    trees.reserve(60);
    for (const auto& mesh : parts.meshes) trees.push_back(Recommended::hierarchy(mesh));
    const auto shapes = shapes_over(parts.meshes, trees, 60);
    World world(shapes);
    for (std::uint32_t i = 0; i < 60; ++i) world.move(i, parts.poses[i]);
    world.update(
        counter, [](const ObjectPair&) { return Touching(); },
        [&](std::uint32_t, const ObjectPair&, const Touching& query) {
          found[1] += query.touching();
        },
        [](std::uint32_t) {});
    found[0] = world.near();
    found[2] = counter.n_v, found[3] = counter.n_p;
    return found;
  };
  const auto usual = play(Parts(Vec3<double>::Zero())), now = play(Parts(survey));
  EXPECT_EQ(now[0], usual[0]);
  EXPECT_EQ(now[1], usual[1]);
  expect_no_more(now[2], usual[2]), expect_no_more(now[3], usual[3]);
}

}  // namespace
}  // namespace bvlab
