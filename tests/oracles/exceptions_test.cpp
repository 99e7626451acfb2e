// SPDX-License-Identifier: BSD-3-Clause
/// A query or a caller that throws loses no later answer: frames after an exception are answered as
/// by brute force, whatever is kept from frame to frame. Work that throws is done by the next who
/// asks.
#include <gtest/gtest.h>

#include <stdexcept>

#include "hierarchies/geometry/once.hpp"
#include "hierarchies/volumes/slab_box.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "tests/oracles/every_strategy.hpp"
#include "traversal/world.hpp"

namespace bvlab {
namespace {

/// A query that throws in place of one call too many.
template <class Query>
class Throwing : public Query {
 public:
  template <class... Arguments>
  explicit Throwing(int calls, Arguments&... arguments) : Query(arguments...), calls_(calls) {}

  Outcome primitives(std::span<const Candidate> pending) {
    count();
    return Query::primitives(pending);
  }
  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    count();
    return Query::primitives(pending, verdicts);
  }
  bool known(std::uint32_t a, std::uint32_t b) {
    count();
    return Query::known(a, b);
  }

 private:
  void count() {
    if (calls_-- == 0) throw std::runtime_error("one call too many");
  }
  int calls_;
};

constexpr int always = 1 << 30;  // calls, without an exception

/// Some frames end by an exception, of a query or of the caller that takes its answer, and are
/// followed by the next frame or by another run at the same poses.
template <class Engine>
void expect_answers_after_exceptions(Engine& engine, const Scene& scene, const Truth& truth,
                                     std::string_view whose) {
  const std::size_t pairs = engine.pairs().size();
  std::mt19937 random(20261126);
  std::vector<std::vector<Contact>> found(pairs);
  std::vector<std::uint8_t> touching(pairs);
  NotCounting counter;
  int thrown = 0;
  const auto run = [&](std::size_t f, bool contacts, int calls, std::size_t answers) {
    for (auto& each : found) each.clear();
    std::size_t taken = 0;
    const auto take = [&] {
      if (taken++ == answers) throw std::runtime_error("enough answers");
    };
    if (contacts)
      engine.frame(
          scene.frames[f], counter,
          [&](std::size_t p) { return Throwing<Contacts>(calls, found[p]); },
          [&](std::size_t, const auto&) { take(); });
    else
      engine.frame(
          scene.frames[f], counter, [&](std::size_t) { return Throwing<Touching>(calls); },
          [&](std::size_t p, const auto& query) { take(), touching[p] = query.touching(); });
  };
  for (const bool contacts : {false, true})
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      if (f % 3 > 0) {
        try {
          const bool by_query = random() % 2;
          run(f, contacts, by_query ? static_cast<int>(random() % 3) : always,
              by_query ? pairs : random() % pairs);
        } catch (const std::runtime_error&) {
          ++thrown;
        }
        if (f % 3 == 1) continue;
      }
      run(f, contacts, always, pairs);
      for (std::size_t p = 0; p < pairs; ++p)
        if (contacts) {
          std::sort(found[p].begin(), found[p].end());
          ASSERT_EQ(found[p], truth.contacts[f * pairs + p]) << whose << ", frame " << f;
        } else {
          ASSERT_EQ(touching[p], truth.touching[f * pairs + p]) << whose << ", frame " << f;
        }
    }
  EXPECT_GT(thrown, 10) << whose;
}

TEST(Exceptions, EveryStrategyStartsAnew) {
  for (const auto& motion : motions_with_truth())
    for_each_strategy(motion.first, [&](auto& engine, std::string_view name) {
      expect_answers_after_exceptions(engine, motion.first, motion.second, name);
    });
}

template <class V, int F, class Kernel, class Memory = WideMargins>
void expect_wide_pairs_start_anew(const Memory& memory = {}) {
  for (const auto& [scene, truth] : motions_with_truth()) {
    PlayedWide<V, F, Memory, Kernel> played(scene, static_cast<std::uint32_t>(F), memory);
    expect_answers_after_exceptions(played.engine(), scene, truth, Kernel::name);
  }
}
TEST(Exceptions, WidePairsStartAnew) {
  expect_wide_pairs_start_anew<SlabBox<float>, 8, SiblingsKernel>();
  expect_wide_pairs_start_anew<Obb<float>, 4, MixedKernel>();
  expect_wide_pairs_start_anew<Obb<float>, 4, MixedKernel, ListMemory>(raised_lists());
}

TEST(Once, WorkThatThrowsIsDoneByTheNext) {
  for (const Sharing sharing : {Sharing::one_thread, Sharing::several_threads}) {
    std::uint32_t done = never_done;
    EXPECT_THROW(once(done, 1, sharing, [] { throw std::runtime_error("once"); }),
                 std::runtime_error);
    EXPECT_TRUE(once(done, 1, sharing, [] {}));
    EXPECT_FALSE(once(done, 1, sharing, [] {}));
  }
}

}  // namespace
}  // namespace bvlab
