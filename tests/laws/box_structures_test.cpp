// SPDX-License-Identifier: BSD-3-Clause
/// The stores that sweeps stand on, alone, against a plain list; and the list that is changed in
/// place.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "broadphase/methods/blocks.hpp"
#include "broadphase/methods/sweep.hpp"
#include "broadphase/structures/kept_pairs.hpp"
#include "broadphase/structures/pair_difference.hpp"
#include "tests/laws/boxes_for_test.hpp"

namespace bvlab {
namespace {

template <class S>
class RectangleStores : public ::testing::Test {};
using Stores = ::testing::Types<HashedLists<float>, HashedTrees<float>, OneTree<float>,
                                HashedStrips<float>, HashedLists<double>, HashedTrees<double>,
                                OneTree<double>, HashedStrips<double>>;
TYPED_TEST_SUITE(RectangleStores, Stores);

TYPED_TEST(RectangleStores, AnswersAsAListDoes) {
  using T = typename TypeParam::Scalar;
  static_assert(RectangleStore<TypeParam>);
  TypeParam store;
  for (const auto& [name, boxes] : BoxMaker<T>(4).cases(120)) {
    if (boxes.empty()) continue;
    store.prepare(boxes);
    std::set<std::uint32_t> in;
    BoxMaker<T> random(9);
    for (int step = 0; step < 600; ++step) {
      const auto k = random.below(static_cast<unsigned>(boxes.size()));
      if (in.contains(k)) {
        store.remove(k);
        in.erase(k);
        continue;
      }
      std::vector<std::uint32_t> found, right;
      store.overlapping(k, [&](std::uint32_t other) { found.push_back(other); });
      std::sort(found.begin(), found.end());
      for (const std::uint32_t other : in)
        if (rectangles_overlap(boxes[k], boxes[other])) right.push_back(other);
      ASSERT_EQ(found, right) << name << ", step " << step;
      store.insert(k);
      in.insert(k);
    }
  }
}

TEST(PairSlots, RemembersWhatItWasTold) {
  BoxMaker<float> random(1);
  PairSlots slots;
  std::map<Pair, std::uint32_t> right;
  for (int step = 0; step < 20000; ++step) {
    const Pair pair{random.below(30), 30 + random.below(30)};
    const auto known = right.find(pair);
    ASSERT_EQ(slots.find(pair), known == right.end() ? PairSlots::none : known->second);
    if (random.below(2)) {
      slots.put(pair, static_cast<std::uint32_t>(step));
      right[pair] = static_cast<std::uint32_t>(step);
    } else {
      slots.erase(pair);
      right.erase(pair);
    }
    ASSERT_EQ(slots.size(), right.size());
  }
}

TEST(KeptPairs, HoldsWhatWasAddedAndNotRemoved) {
  BoxMaker<float> random(2);
  KeptPairs kept;
  std::set<Pair> right;
  PairList& list = kept.rewritten();
  for (std::uint32_t k = 0; k < 200; ++k) list.push({k, k + 1}), right.insert({k, k + 1});
  for (int step = 0; step < 5000; ++step) {
    const std::uint32_t k = random.below(300);
    const Pair pair{k, k + 1};
    if (right.contains(pair)) {
      kept.remove(pair, {0, 200});
      right.erase(pair);
    } else {
      kept.add(pair);
      right.insert(pair);
    }
    if (step % 50 == 0) {
      ASSERT_EQ(sorted(kept.view()), std::vector<Pair>(right.begin(), right.end()));
    }
  }
}

TEST(PairDifference, IsTheDifferenceOfSets) {
  BoxMaker<float> random(3);
  PairDifference difference;
  PairList began, ended;
  for (int round = 0; round < 20; ++round) {
    std::set<Pair> before, now;
    for (int k = 0; k < 300; ++k) {
      const Pair pair{random.below(40), 40 + random.below(1u << 20)};
      if (random.below(3) > 0) before.insert(pair);
      if (random.below(3) > 0) now.insert(pair);
    }
    const std::vector<Pair> a(before.begin(), before.end()), b(now.begin(), now.end());
    difference(a, b, began, ended);
    std::vector<Pair> right_began, right_ended;
    std::set_difference(b.begin(), b.end(), a.begin(), a.end(), std::back_inserter(right_began));
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(right_ended));
    EXPECT_EQ(sorted(began.view()), right_began);
    EXPECT_EQ(sorted(ended.view()), right_ended);
  }
}

/// Two threads give the list of one, pair for pair.
TEST(Blocks, ThreadsChangeNothing) {
  const auto boxes = BoxMaker<float>(8).boxes(30000, 0, 1, 0.005f, 0.03f);
  MethodSettings one, two;
  two.threads = 2;
  Blocks<float, Closed> alone(one), together(two);
  for (int frame = 0; frame < 2; ++frame) {
    const auto a = alone.overlapping(boxes), b = together.overlapping(boxes);
    ASSERT_GT(a.size(), 1000u);
    ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
  }
}

}  // namespace
}  // namespace bvlab
