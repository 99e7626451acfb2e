// SPDX-License-Identifier: BSD-3-Clause
/// The program's replays by the kernel over siblings find what recursion over binary trees finds.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/registry.hpp"
#include "tests/oracles/settings.hpp"

namespace bvlab {
namespace {

Variant binary(const std::string& query) {
  Variant variant;
  variant.query = query;
  return variant;
}

constexpr const char* all_strategies[] = {
    "recursive",  "recursive-both", "witness", "separation-list", "deferred",
    "deferred:3", "by-cost",        "raise",   "margins",         "adaptive"};

Variant wide(const std::string& query, const char* kernel = "siblings") {
  Variant variant = binary(query);
  set_kernel(variant, kernel);
  variant.volume = variant.kernel == "mixed" ? "obb" : "slab-box";
  return variant;
}

ReplayOptions options(unsigned threads) {
  ReplayOptions options;
  options.threads = threads;
  return options;
}

/// A query of any name is written by what it answered.
TEST(WideReplays, AnswersAreKnownByWhatIsFilled) {
  ReplayResult result;
  EXPECT_EQ(kind_of_answers(result, "touching"), AnswerKind::yes_or_no);
  EXPECT_EQ(kind_of_answers(result, "distance"), AnswerKind::number);
  EXPECT_EQ(kind_of_answers(result, "contacts"), AnswerKind::contacts);
  result.touching = {0, 1};
  EXPECT_EQ(kind_of_answers(result, "mine"), AnswerKind::yes_or_no);
  result = {};
  result.distances = {0.5};
  EXPECT_EQ(kind_of_answers(result, "mine"), AnswerKind::number);
}

/// Distances to the rounding that both leave open.
void expect_same(const ReplayResult& found, const ReplayResult& truth, const std::string& where) {
  EXPECT_EQ(found.touching, truth.touching) << where;
  EXPECT_EQ(found.contacts, truth.contacts) << where;
  EXPECT_EQ(found.hits, truth.hits) << where;
  ASSERT_EQ(found.distances.size(), truth.distances.size()) << where;
  for (std::size_t i = 0; i < truth.distances.size(); ++i) {
    EXPECT_EQ(found.distances[i] == 0, truth.distances[i] == 0) << where << ' ' << i;
    EXPECT_NEAR(found.distances[i], truth.distances[i], 1e-13 * truth.distances[i]) << where;
  }
}

/// A body that jumps to where floats end, or beyond, and comes back: a gap there is no licence to
/// rest for ever. It is away for one frame or for two.
TEST(WideReplays, ABodyComesBackFromBeyondTheFloats) {
  for (const double away : {1e29, 1e31, 1e35, 1e38, 3.3e38, 4e38, 1e40, 1e43, 1e46, 1e200}) {
    const std::vector<TriangleMesh> meshes{formula_mesh("star", 60)};
    constexpr std::size_t frames = 60;
    Trace trace{frames, 2, std::vector<double>(frames * 2 * 7, 0)};
    for (std::size_t frame = 0; frame < frames; ++frame)
      for (std::size_t i = 0; i < 2; ++i) {
        double* const pose = &trace.values[(frame * 2 + i) * 7];
        pose[3] = 1;
        if (i == 1) pose[0] = frame % 3 == 0 || frame % 5 == 0 ? away : 0.1 * double(frame % 4);
      }
    const auto truth = replay(meshes, trace, binary("touching"), {});
    EXPECT_GT(truth.hits, 20u);
    for (const std::string volume : {"slab-box", "obb"})
      for (const char* strategy : all_strategies)
        for (const char* kernel : {"siblings", "mixed"}) {
          if (kernel == std::string("mixed") && volume != "obb") continue;
          Variant variant = wide("touching", kernel);
          variant.volume = volume, variant.strategy = strategy;
          EXPECT_EQ(replay(meshes, trace, variant, {}).touching, truth.touching)
              << volume << ' ' << strategy << ' ' << kernel << ' ' << away;
        }
    for (const char* strategy : {"margins", "adaptive"}) {
      Variant variant = binary("touching");
      variant.strategy = strategy;
      EXPECT_EQ(replay(meshes, trace, variant, {}).touching, truth.touching) << strategy << away;
    }
  }
}

/// Two bodies at rest, of a mesh each.
void expect_same_at_rest(const std::vector<TriangleMesh>& meshes, const Pose& first,
                         const std::string& query) {
  Trace trace{3, 2, {}};
  const Eigen::Quaterniond q(first.rotation);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    const auto& t = first.translation;
    for (const double x : {t[0], t[1], t[2], q.w(), q.x(), q.y(), q.z()}) trace.values.push_back(x);
    for (const double x : {0, 0, 0, 1, 0, 0, 0}) trace.values.push_back(x);
  }
  const auto truth = replay(meshes, trace, binary(query), {});
  for (const char* kernel : {"siblings", "mixed"})
    for (const std::string volume : {"slab-box", "obb"})
      for (const char* strategy : all_strategies) {
        if (kernel == std::string("mixed") && volume != "obb") continue;
        Variant variant = wide(query, kernel);
        variant.volume = volume, variant.strategy = strategy;
        expect_same(replay(meshes, trace, variant, {}), truth, volume + ' ' + kernel);
      }
}

/// The squares of its normal are subnormal: divided by the root of their sum it is 1.235 long, and
/// gaps along it are too large. Of two triangles above it one is nearer, the other seems so.
TEST(WideReplays, ASliverHasANormalOfUnitLength) {
  TriangleMesh sliver, two;
  sliver.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 2.3e-162, 1.5e-162}};
  sliver.triangles = {{0, 1, 2}};
  const Vec3<double> up = Vec3<double>(0, -1.5, 2.3).normalized(), aside(0, up[2], -up[1]);
  for (const Vec3<double>& at : {Vec3<double>(0.5 * Vec3<double>::UnitX() + 1.0 * up),
                                 Vec3<double>(0.5 * Vec3<double>::UnitX() + 1.2 * aside)}) {
    const auto first = static_cast<std::uint32_t>(two.vertices.size());
    for (const Vec3<double>& corner :
         {Vec3<double>(0, 0, 0), Vec3<double>(1e-3, 0, 0), Vec3<double>(1e-3 * up)})
      two.vertices.push_back(at + corner);
    two.triangles.push_back({first, first + 1, first + 2});
  }
  expect_same_at_rest({two, sliver}, Pose{}, "distance");
}

/// The sums by which float corners are transformed overflow on their way to a finite end.
TEST(WideReplays, CornersThatOverflowOnTheirWay) {
  const auto triangle = [](const Vec3<double>& at, const Vec3<double>& e, const Vec3<double>& f) {
    TriangleMesh mesh;
    mesh.vertices = {at, at + e, at + f};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
  };
  const Pose turned = *pose_from({3e38, -3e38, 0}, std::cos(M_PI / 8), 0, 0, std::sin(M_PI / 8));
  const TriangleMesh a = triangle({3e38, 3e38, 0}, {1e37, 0, 0}, {0, 1e37, 0});
  const Vec3<double> middle = turned({3.025e38, 3.025e38, 0});
  const TriangleMesh b =
      triangle(middle - Vec3<double>(0, 0, 1e37), {1e36, 0, 2e37}, {0, 1e36, 2e37});
  for (const char* query : {"touching", "contacts"}) {
    expect_same_at_rest({a, b}, turned, query);
  }
}

class WideReplay : public testing::TestWithParam<const char*> {};

TEST_P(WideReplay, IsRecursionOverBinaryTrees) {
  const std::string query = GetParam();
  std::uint64_t hits = 0;
  for (const auto& setting : settings(query == "touching" ? 300 : 60)) {
    const Played scene = played(setting);
    const auto truth = replay(scene.meshes, scene.trace, binary(query), {});
    hits += truth.hits;
    for (const unsigned threads : {1u, 2u})
      for (const std::uint32_t leaf_size : {1u, 3u, 1000u}) {
        Variant variant = wide(query, (leaf_size == 3) != (threads == 2) ? "mixed" : "siblings");
        if (threads == 2) variant.strategy = "margins";
        variant.leaf_size = leaf_size;
        variant.build = leaf_size == 3 ? "bottom-up" : "top-down-surface-area";
        expect_same(replay(scene.meshes, scene.trace, variant, options(threads)), truth,
                    setting.name + (" leaves of " + std::to_string(leaf_size)));
      }
  }
  EXPECT_GT(hits, 0u);
}

TEST_P(WideReplay, ConfigurationsAnswerTheSame) {
  const Played scene = played(settings(60)[0]);
  const auto truth = replay(scene.meshes, scene.trace, binary(GetParam()), {});
  for (const auto& each : configurations()) {
    const Variant variant = configured(binary(GetParam()), each.name);
    if (has(volumes(), variant.volume))
      expect_same(replay(scene.meshes, scene.trace, variant, options(2)), truth, each.name);
  }
}

TEST_P(WideReplay, FewObjectsAndFrames) {
  const std::vector<TriangleMesh> meshes{formula_mesh("star", 60)};
  for (const auto& [frames, objects] :
       {std::pair<std::size_t, std::size_t>{0, 0}, {0, 1}, {0, 5}, {3, 0}, {3, 1}, {1, 2}}) {
    Trace trace{frames, objects, {}};
    for (std::size_t i = 0; i < frames * objects; ++i)
      trace.values.insert(trace.values.end(), {0.1 * static_cast<double>(i), 0, 0, 1, 0, 0, 0});
    const auto truth = replay(meshes, trace, binary(GetParam()), {});
    for (const char* kernel : {"siblings", "mixed"})
      for (const unsigned threads : {1u, 2u})
        expect_same(replay(meshes, trace, wide(GetParam(), kernel), options(threads)), truth,
                    std::to_string(frames) + " of " + std::to_string(objects));
  }
}

INSTANTIATE_TEST_SUITE_P(Queries, WideReplay, testing::Values("touching", "contacts", "distance"),
                         [](const auto& info) { return std::string(info.param); });

/// Every pair is looked at, and no fewer triangles than touch are tested.
TEST(WideReplays, CountWhatTheyDo) {
  const Played scene = played(settings(40)[0]);
  for (const char* query : {"touching", "contacts"}) {
    ReplayOptions counting = options(1);
    counting.count = Count::on;
    const auto one = replay(scene.meshes, scene.trace, wide(query), counting);
    EXPECT_EQ(one.considered, scene.trace.pairs() * scene.trace.frames);
    EXPECT_GE(one.n_v, one.considered);
    EXPECT_GE(one.n_p, one.hits);
    EXPECT_GT(one.n_u, 0u);
    EXPECT_EQ(one.front, 0);
    counting.keep_series = true;
    const auto series = replay(scene.meshes, scene.trace, wide(query), counting);
    std::uint64_t n_v = 0;
    for (const auto& frame : series.series) n_v += frame.n_v;
    EXPECT_EQ(n_v, one.n_v);
  }
}

/// Where bodies are near each other and do not touch, margins keep fronts: the same for any number
/// of threads.
TEST(WideReplays, MarginsHaveFrontsWithALength) {
  const Played slow = played({"slow", {{"knot", 480}}, walk(6, 60, 2.5, 0.001, 0.1, 0)});
  for (const char* kernel : {"siblings", "mixed"}) {
    Variant variant = wide("touching", kernel);
    variant.strategy = "margins";
    const double one = replay(slow.meshes, slow.trace, variant, options(1)).front;
    EXPECT_GT(one, 0) << kernel;
    EXPECT_EQ(one, replay(slow.meshes, slow.trace, variant, options(2)).front);
  }
}

TEST(WideReplays, RefuseWhatThereIsNot) {
  const auto refused = [](auto change) {
    Variant variant = wide("touching");
    change(variant);
    EXPECT_THROW(check(variant), Unusable);
  };
  refused([](Variant& v) { v.volume = "cylinder"; });
  refused([](Variant& v) { v.strategy = "deferred:many"; });
  refused([](Variant& v) { v.strategy = "kinetic-list"; });
  refused([](Variant& v) { v.fan_out = 3; });
  refused([](Variant& v) { v.frame = "mine"; });
  refused([](Variant& v) { v.kernel = "tall"; });
  refused([](Variant& v) { v.kernel = "gathered", v.fan_out = 3; });
  refused([](Variant& v) { v.kernel = "gathered", v.frame = "mine"; });
  EXPECT_THROW(configured(Variant{}, "best"), Unusable);
}

}  // namespace
}  // namespace bvlab
