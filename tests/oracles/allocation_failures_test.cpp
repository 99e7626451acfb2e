// SPDX-License-Identifier: BSD-3-Clause
/// A failed allocation loses no later answer. In each frame allocations fail: the first, then the
/// second of those that are still made, and so on, until a run of the frame succeeds; after some
/// frames that have failed once, the next one follows. All answers are those of brute force. A body
/// whose first move failed can be moved again.
#include <gtest/gtest.h>

#include "hierarchies/volumes/slab_box.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "tests/oracles/every_strategy.hpp"
#include "tests/replaced_new.hpp"
#include "traversal/body.hpp"

namespace bvlab {
namespace {

int successes = -1;  // allocations before one that fails; negative: none fails
int failures = 0;

void fail_after_successes() {
  if (successes >= 0 && successes-- == 0) {
    ++failures;
    throw std::bad_alloc();
  }
}
[[maybe_unused]] const auto hook = before_allocation = fail_after_successes;

/// Calls work() with its first allocation failing, then with its second, and so on, until none
/// fails.
template <class Work>
void with_each_allocation_failing(Work&& work) {
  for (int k = 0;; ++k) {
    successes = k;
    try {
      work();
    } catch (const std::bad_alloc&) {
      continue;
    }
    successes = -1;
    return;
  }
}

/// Plays the frames with one kind of query. `run(f)` forgets all answers and runs frame f, and
/// `check(f)` compares them.
template <class Run, class Check>
void play_with_failures(std::size_t frames, Run&& run, Check&& check) {
  for (std::size_t f = 0; f < frames; ++f) {
    if (f % 4 == 2) {
      successes = static_cast<int>(f % 3);
      try {
        run(f);
      } catch (const std::bad_alloc&) {
      }
      successes = -1;
      continue;
    }
    with_each_allocation_failing([&] { run(f); });
    check(f);
  }
}

template <class Engine>
void expect_answers_after_failures(Engine& engine, const Scene& scene, const Truth& truth,
                                   std::string_view whose) {
  const std::size_t pairs = engine.pairs().size(), frames = scene.frames.size();
  NotCounting counter;
  failures = 0;
  std::vector<std::uint8_t> touching(pairs);
  play_with_failures(
      frames,
      [&](std::size_t f) {
        std::fill(touching.begin(), touching.end(), 2);
        engine.frame(
            scene.frames[f], counter, [](std::size_t) { return Touching(); },
            [&](std::size_t p, const Touching& query) { touching[p] = query.touching(); });
      },
      [&](std::size_t f) {
        for (std::size_t p = 0; p < pairs; ++p)
          ASSERT_EQ(touching[p], truth.touching[f * pairs + p]) << whose << ", frame " << f;
      });
  EXPECT_GT(failures, 0) << whose;
  std::vector<std::vector<Contact>> found(pairs);
  play_with_failures(
      frames,
      [&](std::size_t f) {
        for (auto& each : found) each = {};
        engine.frame(
            scene.frames[f], counter, [&](std::size_t p) { return Contacts(found[p]); },
            [](std::size_t, const Contacts&) {});
      },
      [&](std::size_t f) {
        for (std::size_t p = 0; p < pairs; ++p) {
          std::sort(found[p].begin(), found[p].end());
          ASSERT_EQ(found[p], truth.contacts[f * pairs + p]) << whose << ", frame " << f;
        }
      });
  std::vector<double> distances(pairs);
  play_with_failures(
      frames,
      [&](std::size_t f) {
        std::fill(distances.begin(), distances.end(), -1);
        engine.frame(
            scene.frames[f], counter, [](std::size_t) { return Distance(); },
            [&](std::size_t p, const Distance& query) { distances[p] = query.distance(); });
      },
      [&](std::size_t f) {
        for (std::size_t p = 0; p < pairs; ++p) {
          const double exact = truth.distances[f * pairs + p];
          ASSERT_NEAR(distances[p], exact, 1e-9 * (1 + exact)) << whose << ", frame " << f;
        }
      });
}

TEST(AllocationFailures, EveryStrategyStartsAnew) {
  std::size_t first = 0;
  for (const auto& motion : motions_with_truth()) {
    std::size_t number = first++;  // every strategy on every fourth motion
    for_each_strategy(motion.first, [&](auto& engine, std::string_view name) {
      if (number++ % 4 == 0)
        expect_answers_after_failures(engine, motion.first, motion.second, name);
    });
  }
}

template <class V, int F, class Memory, class Kernel>
void expect_wide_pairs_start_anew(const Memory& memory = {}) {
  for (const auto& [scene, truth] : motions_with_truth()) {
    PlayedWide<V, F, Memory, Kernel> played(scene, static_cast<std::uint32_t>(F), memory);
    expect_answers_after_failures(played.engine(), scene, truth, Kernel::name);
  }
}
TEST(AllocationFailures, WidePairsStartAnew) {
  expect_wide_pairs_start_anew<SlabBox<float>, 8, WideMargins, SiblingsKernel>();
  expect_wide_pairs_start_anew<Obb<float>, 4, WideMargins, MixedKernel>();
  expect_wide_pairs_start_anew<Obb<float>, 4, ListMemory, MixedKernel>(raised_lists());
  expect_wide_pairs_start_anew<Obb<float>, 4, NoMemory, MixedKernel>();
}

TEST(AllocationFailures, ABodyIsMovedAgain) {
  using V = Obb<float>;
  const TriangleMesh mesh = formula_mesh("star", 24);
  const Hierarchy<V> hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  Body<V> body(mesh, hierarchy);
  const Pose pose = *pose_from(Vec3<double>(1, 2, 3), 0.1, 0.2, 0.3, 1);
  failures = 0;
  with_each_allocation_failing([&] { body.move(pose, Vec3<double>::Zero()); });
  EXPECT_GT(failures, 0);
  for (std::uint32_t i = 0; i < hierarchy.primitives(); ++i)
    EXPECT_EQ(body.triangle(i), pose(mesh.corners(hierarchy.primitive(i))));
  std::size_t posed = 0;
  body.require(0, posed);
  EXPECT_EQ(posed, 1u);
}

TEST(WidePairs, TooManyAreRefused) {
  WidePairs<SlabBox<float>, 8, NoMemory, SiblingsKernel> pairs(
      std::span<const WideShape<SlabBox<float>, 8, SiblingsKernel>>{});
  EXPECT_THROW(pairs.put(1u << 30, {0, 1}), std::length_error);
  EXPECT_TRUE(pairs.pairs().empty());
}

}  // namespace
}  // namespace bvlab
