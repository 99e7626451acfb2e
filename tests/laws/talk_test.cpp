// SPDX-License-Identifier: BSD-3-Clause
/// What the talk says of steps, of two runs without growth, and its example (li1998incremental).
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <string>

#include "experiments/replay/coherence.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "traversal/node_pair.hpp"

namespace bvlab {
namespace {

/// Two stars that reach as far as 1, the second of which is turned and at each of the places in
/// turn: beside the first, so that no centres of volumes pass each other.
CoherenceSums of_stars(const std::vector<double>& places, const std::string& volume,
                       const std::string& query = "contacts") {
  const TriangleMesh star = formula_mesh("star", 200);
  Trace trace{places.size(), 2, {}};
  for (const double x : places)
    for (const double v : {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, x, 0.0, 0.0, 0.9, 0.1, 0.2, 0.3})
      trace.values.push_back(v);
  Variant variant;
  variant.volume = volume, variant.query = query, variant.leaf_size = 1;
  return coherence({&star, 1}, trace, variant);
}

const StepSums& of(const CoherenceSums& sums, Step step) {
  return sums.steps[static_cast<std::size_t>(step)];
}
std::uint64_t all_steps(const CoherenceSums& sums) {
  return std::accumulate(sums.steps.begin(), sums.steps.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const StepSums& s) { return sum + s.runs; });
}
/// What a list that never shrinks saves over recursion.
std::uint64_t saved(const StepSums& s) { return s.tests - s.again; }

class Talk : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Volumes, Talk, ::testing::Values("sphere", "obb"));

TEST_P(Talk, BodiesAtRestAreStill) {
  const CoherenceSums sums = of_stars(std::vector<double>(6, 1.6), GetParam());
  const StepSums& still = of(sums, Step::still);
  EXPECT_EQ(still.runs, 5u);
  EXPECT_EQ(still.runs, all_steps(sums));
  EXPECT_EQ(still.again, still.entries);
  EXPECT_EQ(saved(still), still.entries - still.runs);  // of n entries, n - 1
  // A parent for each two entries that are siblings: no more than half as many.
  EXPECT_GT(still.raised, still.again);
  EXPECT_LE(still.raised, still.again + still.entries / 2);
  for (std::size_t i = 0; i < two_runs.size(); ++i) {
    const bool is_still = two_runs[i].first == Step::still && two_runs[i].second == Step::still;
    EXPECT_EQ(sums.two[i].runs, is_still ? 3u : 0u);
    if (is_still) {
      EXPECT_EQ(sums.two[i].rebuilt, 2 * sums.two[i].kept - 3);
    }
  }
}

TEST_P(Talk, StarsThatComeNearerAreDown) {
  const CoherenceSums sums = of_stars({1.9, 1.8, 1.7, 1.6, 1.5}, GetParam());
  const StepSums& down = of(sums, Step::down);
  EXPECT_EQ(down.runs, 4u);
  EXPECT_EQ(down.runs, all_steps(sums));
  EXPECT_EQ(saved(down), down.entries - down.runs);  // n - 1, however far it was descended
  for (const TwoRunSums& two : sums.two) EXPECT_EQ(two.runs, 0u);
}

TEST_P(Talk, StarsThatPartAreUp) {
  const CoherenceSums sums = of_stars({1.5, 1.6, 1.7, 1.8, 1.9}, GetParam());
  const StepSums& up = of(sums, Step::up);
  EXPECT_EQ(up.runs, 4u);
  EXPECT_EQ(up.runs, all_steps(sums));
  EXPECT_EQ(up.again, up.entries);
  EXPECT_GT(up.raised, up.again);
  EXPECT_EQ(sums.two[0].runs, 2u);  // (up, up), with a run after it
  EXPECT_LT(sums.two[0].rebuilt, 2 * sums.two[0].kept);
}

TEST_P(Talk, WhatGoesUpMayComeDownWithoutGrowth) {
  const CoherenceSums sums = of_stars({1.6, 1.7, 1.6, 1.6}, GetParam());
  EXPECT_EQ(of(sums, Step::up).runs, 1u);
  EXPECT_EQ(of(sums, Step::down).runs, 1u);
  EXPECT_EQ(sums.two[2].runs, 1u);  // (up, down)
  EXPECT_EQ(std::accumulate(sums.two.begin(), sums.two.end(), std::uint64_t{0},
                            [](std::uint64_t sum, const TwoRunSums& s) { return sum + s.runs; }),
            1u);
}

TEST_P(Talk, RunsThatAHitCutsShortAreNoSteps) {
  const CoherenceSums sums = of_stars({0.2, 0.2, 0.3, 0.3, 0.4}, GetParam(), "touching");
  EXPECT_EQ(sums.near_runs, 4u);
  EXPECT_EQ(all_steps(sums), 0u);
  for (const TwoRunSums& two : sums.two) EXPECT_EQ(two.runs, 0u);
}

/// The example: nodes A to G of one tree and a to g of the other, B and C below A, D and E below B,
/// F and G below C.
struct Example {
  struct Node {
    std::uint32_t count;
    int size;
  };
  static int number(char name) { return (name | 32) - 'a'; }
  static Node node(char name) {
    return {number(name) > 2, number(name) == 0 ? 3 : number(name) < 3 ? 2 : 1};
  }
  static std::array<char, 2> children(char name) {
    const char first = static_cast<char>(name + number(name) + 1);
    return {first, static_cast<char>(first + 1)};
  }
  static std::string leaves(char name) {
    if (node(name).count) return {name};
    const auto [first, second] = children(name);
    return leaves(first) + leaves(second);
  }

  static inline const std::string ends = "Bb Dc Ef Eg Fb Gb Cc";
  std::string found;
  int tests = 0;

  void recurse(char a, char b) {
    ++tests;
    const std::string pair{a, b};
    if (ends.find(pair) != ends.npos) {
      found += (found.empty() ? "" : " ") + pair;
      return;
    }
    const bool by_b = into_larger(node(a), node(b)) == Descent::b;
    for (const char child : children(by_b ? b : a)) by_b ? recurse(a, child) : recurse(child, b);
  }
};

TEST(TalksExample, RecursionStopsAtTheListInItsOrder) {
  Example example;
  example.recurse('A', 'a');
  EXPECT_EQ(example.found, Example::ends);
  EXPECT_EQ(example.tests, 2 * 7 - 1);
  std::map<std::string, int> covered;
  for (std::size_t i = 0; i < Example::ends.size(); i += 3)
    for (const char a : Example::leaves(Example::ends[i]))
      for (const char b : Example::leaves(Example::ends[i + 1])) ++covered[{a, b}];
  EXPECT_EQ(covered.size(), 16u);
  for (const auto& [pair, times] : covered) EXPECT_EQ(times, 1) << pair;
}

}  // namespace
}  // namespace bvlab
