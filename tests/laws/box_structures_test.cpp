// SPDX-License-Identifier: BSD-3-Clause
/// The stores that sweeps stand on, alone, against a plain list; and the list that is changed in
/// place.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "broadphase/methods/blocks.hpp"
#include "broadphase/methods/sweep.hpp"
#include "broadphase/structures/pair_difference.hpp"
#include "broadphase/structures/pair_places.hpp"
#include "broadphase/structures/pair_slots.hpp"
#include "broadphase/structures/sorted_ends.hpp"
#include "tests/laws/boxes_for_test.hpp"

namespace bvlab {
namespace {

/// Both sorts, from scratch and repaired, more moved than repairing bears and less, equal ones
/// among them.
TEST(SortedEnds, AreInOrderHoweverTheyAreSorted) {
  for (const Sort sort : {Sort::radix, Sort::comparison})
    for (const Coherence coherence : {Coherence::off, Coherence::on}) {
      SortedEnds<float> ends(coherence, sort);
      BoxMaker<float> random(3);
      std::vector<float> at(500);
      for (float& x : at) x = static_cast<float>(random.below(100)) - 50;
      for (int frame = 0; frame < 30; ++frame) {
        for (float& x : at)
          if (frame % 10 == 9)
            x = random.uniform(-50, 50);
          else if (random.below(4) == 0)
            x += random.uniform(-1, 1);
        const auto found = ends(500, [&](std::uint32_t k) { return at[k]; });
        std::set<std::uint32_t> ids;
        for (std::size_t k = 0; k < found.size(); ++k) {
          ids.insert(found[k].id);
          if (k > 0) {
            ASSERT_LE(at[found[k - 1].id], at[found[k].id]) << "frame " << frame;
          }
        }
        ASSERT_EQ(ids.size(), 500u);
      }
    }
}

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

/// Boxes that move against the definition: the list, and what it says changed.
template <class T>
class CandidateLists : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(CandidateLists, Scalars);

TYPED_TEST(CandidateLists, HoldsWhatOverlaps) {
  using T = TypeParam;
  BoxMaker<T> random(2);
  Frame<T> boxes = random.boxes(60, 0, 1, T(0.1), T(0.3));
  CandidatePairs<T, Closed> candidates;
  std::vector<std::uint32_t> ids(boxes.size());
  for (std::uint32_t k = 0; k < ids.size(); ++k) ids[k] = (7 * k) % 60;  // slot to box
  candidates.rows().resize(boxes.size());
  for (std::uint32_t a = 0; a < 60; ++a)
    for (std::uint32_t b = a + 1; b < 60; ++b)
      if (b < 50) candidates.add(a, ids[a], b, ids[b]);
  std::vector<Pair> before;
  PairList list, began, ended;
  std::fill(candidates.rows().begin(), candidates.rows().end(), nowhere_row<T>());
  candidates.compare_all(ids.data(), list, began, ended);
  for (int step = 0; step < 200; ++step) {
    if (step == 50)
      for (std::uint32_t a = 0; a < 60; ++a)
        for (std::uint32_t b = std::max(a + 1, 50u); b < 60; ++b)
          candidates.add(a, ids[a], b, ids[b]);
    for (auto& box : boxes)
      if (step % 3 == 0 || random.below(10) == 0) box = random.box(0, 1, T(0.1), T(0.3));
    for (std::uint32_t slot = 0; slot < 60; ++slot)
      candidates.rows()[slot] = row_of(boxes[ids[slot]]);
    began.clear(), ended.clear();
    candidates.compare_all(ids.data(), list, began, ended);
    std::vector<Pair> right = pairs_by_definition<Closed>(boxes);
    if (step < 50)
      std::erase_if(right, [&](Pair p) {
        // Slots from 50 on are not among the candidates yet; slot s holds box 7 s mod 60, so box b
        // stands in slot 43 b mod 60.
        return (43 * p.i) % 60 >= 50 || (43 * p.j) % 60 >= 50;
      });
    ASSERT_EQ(sorted(list.view()), right) << "step " << step;
    std::vector<Pair> right_began, right_ended;
    std::set_difference(right.begin(), right.end(), before.begin(), before.end(),
                        std::back_inserter(right_began));
    std::set_difference(before.begin(), before.end(), right.begin(), right.end(),
                        std::back_inserter(right_ended));
    ASSERT_EQ(sorted(began.view()), right_began) << "step " << step;
    ASSERT_EQ(sorted(ended.view()), right_ended) << "step " << step;
    before = right;
  }
}

/// Pairs put in and taken out at random, against a set.
TEST(PairPlaces, ChangeTheListInPlace) {
  BoxMaker<float> random(6);
  PairPlaces places;
  PairList list;
  std::set<Pair> right;
  std::vector<std::uint32_t> order;  // with slots that are empty
  for (std::uint32_t k = 0; k < 60; ++k) order.insert(order.end(), {(7 * k) % 60, no_box});
  unsigned boxes = 50;
  for (int step = 0; step < 20000; ++step) {
    if (step == 10000) places.resize(boxes = 60);
    if (step % 4000 == 0 || places.sparse(list)) places.build(list, boxes, order);
    const Pair pair{random.below(boxes), 60 + random.below(20)};
    if (right.insert(pair).second) {
      places.insert(pair, list);
    } else {
      places.erase(pair, list);
      right.erase(pair);
    }
    if (step % 100 == 0) {
      ASSERT_EQ(sorted(list.view()), std::vector<Pair>(right.begin(), right.end()));
    }
  }
}

TEST(Rows, CompareAsBoxesDo) {
  const auto check = [](auto scalar) {
    using T = decltype(scalar);
    for (const auto& [name, boxes] : BoxMaker<T>(5).cases(60))
      for (const auto& a : boxes)
        for (const auto& b : boxes) {
          ASSERT_EQ(overlap<Closed>(row_of(a), row_of(b)), overlap<Closed>(a, b)) << name;
          ASSERT_EQ(overlap<HalfOpen>(row_of(a), row_of(b)), overlap<HalfOpen>(a, b)) << name;
          bool within = true;
          for (int axis = 0; axis < 3; ++axis)
            within &= a.lo[axis] >= b.lo[axis] && a.hi[axis] <= b.hi[axis];
          ASSERT_EQ(inside(row_of(a), row_of(b)), within) << name;
        }
  };
  check(float{});
  check(double{});
  const Box<float> below{{-1, -1, -1}, {-0.0f, 0.0f, -0.0f}}, above{{0.0f, -0.0f, 0.0f}, {1, 1, 1}};
  EXPECT_TRUE(overlap<Closed>(row_of(below), row_of(above)));
  EXPECT_FALSE(overlap<HalfOpen>(row_of(below), row_of(above)));
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

/// Any number of threads gives the lists of one, pair for pair: from scratch, followed, and
/// where a few boxes jump, with changes and without.
TEST(Blocks, ThreadsChangeNothing) {
  const auto expect_same = [](std::span<const Pair> a, std::span<const Pair> b, const char* what,
                              int frame) {
    ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << what << " " << frame;
  };
  for (const int threads : {2, 3, 7})
    for (const Changes changes : {Changes::unreported, Changes::reported}) {
      auto boxes = BoxMaker<float>(8).boxes(20000, 0, 1, 0.005f, 0.06f);
      MethodSettings one, more;
      more.threads = threads, one.changes = more.changes = changes;
      Blocks<float, Closed> alone(one), together(more);
      std::size_t followed = 0, began = 0;
      for (int frame = 0; frame < 14; ++frame) {
        const auto all = alone.overlapping(boxes);
        ASSERT_GT(all.size(), 40000u);
        expect_same(all, together.overlapping(boxes), "all", frame);
        expect_same(alone.changes().began, together.changes().began, "began", frame);
        expect_same(alone.changes().ended, together.changes().ended, "ended", frame);
        EXPECT_EQ(alone.reason(), together.reason());
        followed += together.reason().starts_with("followed");
        began += frame > 0 ? together.changes().began.size() : 0;
        for (std::size_t k = 0; k < boxes.size(); ++k)
          for (int axis = 0; axis < 3; ++axis) {
            float by = k % 3 == static_cast<std::size_t>(axis) ? 1e-4f : -1e-4f;
            if (frame % 4 == 2 && k % 5000 == 77) by = 0.3f;  // a jump
            if (frame % 4 == 3 && k % 1000 == 5) by = 3e-3f;  // out of its fat box
            if (frame == 10) by *= 300;
            boxes[k].lo[axis] += by, boxes[k].hi[axis] += by;
          }
      }
      EXPECT_GT(followed, 8u);
      EXPECT_EQ(began > 0, changes == Changes::reported);
    }
}

/// Candidates that take over from others, prepared while boxes go on, a few of which turn, jump or
/// rest meanwhile; with a new order and without. The pairs are those from scratch in every frame.
TEST(Blocks, FollowsThroughManyCandidates) {
  for (const int threads : {1, 3})
    for (const Changes changes : {Changes::unreported, Changes::reported}) {
      BoxMaker<float> random(21);
      auto boxes = random.boxes(4000, 0, 1, 0.01f, 0.05f);
      std::vector<std::array<float, 3>> velocity;
      for (std::size_t k = 0; k < boxes.size(); ++k)
        velocity.push_back({random.uniform(-6e-4f, 6e-4f), random.uniform(-6e-4f, 6e-4f),
                            random.uniform(-6e-4f, 6e-4f)});
      MethodSettings settings, fresh;
      settings.threads = threads, settings.changes = changes, fresh.coherence = Coherence::off;
      Blocks<float, Closed> blocks(settings), scratch(fresh);
      std::size_t followed = 0, taken_over = 0;
      std::vector<Pair> before;
      for (int frame = 0; frame < 150; ++frame) {
        const auto right = sorted(scratch.overlapping(boxes));
        ASSERT_EQ(sorted(blocks.overlapping(boxes)), right) << "frame " << frame;
        if (changes == Changes::reported) {
          std::vector<Pair> began, ended;
          std::set_difference(right.begin(), right.end(), before.begin(), before.end(),
                              std::back_inserter(began));
          std::set_difference(before.begin(), before.end(), right.begin(), right.end(),
                              std::back_inserter(ended));
          ASSERT_EQ(sorted(blocks.changes().began), began) << "frame " << frame;
          ASSERT_EQ(sorted(blocks.changes().ended), ended) << "frame " << frame;
        }
        before = right;
        followed += blocks.reason().starts_with("followed");
        taken_over += blocks.reason().find("took over") != std::string_view::npos;
        for (std::size_t k = 0; k < boxes.size(); ++k) {
          if (frame % 7 == 3 && k % 400 == 9) velocity[k][1] *= -2;
          if (frame % 50 == 40 && k == 1234) velocity[k][0] = 0.5f;
          if (frame > 80 && k % 3 == 0) continue;
          for (int axis = 0; axis < 3; ++axis) {
            const float by = velocity[k][static_cast<std::size_t>(axis)];
            boxes[k].lo[axis] += by, boxes[k].hi[axis] += by;
          }
          if (velocity[k][0] == 0.5f) velocity[k][0] = 0;
        }
      }
      EXPECT_GT(followed, 100u);
      EXPECT_GT(taken_over, 0u);
    }
}

/// Boxes that jump spoil the order of the others: where more than a few do, every frame is from
/// scratch.
TEST(Blocks, IsNotKeptByJumps) {
  BoxMaker<float> random(4);
  Frame<float> boxes = random.boxes(10000, 0, 1, 0.005f, 0.04f);
  Blocks<float, Closed> blocks(MethodSettings{});
  for (int frame = 0; frame < 20; ++frame) {
    for (int k = 0; k < 1000; ++k) boxes[random.below(10000)] = random.box(0, 1, 0.005f, 0.04f);
    blocks.overlapping(boxes);
    EXPECT_TRUE(blocks.reason().starts_with("from scratch")) << "frame " << frame;
  }
}

/// Boxes that wander, a few in each frame, leave their neighbours in the tree: it is sorted anew
/// once that pays, and not where the same boxes move to and fro.
TEST(Blocks, SortsAnewWhereFewWander) {
  for (const bool wander : {true, false}) {
    BoxMaker<float> random(5);
    Frame<float> boxes = random.boxes(2000, 0, 1, 0.01f, 0.03f);
    Blocks<float, Closed> blocks(MethodSettings{});
    std::size_t changed = 0, sorted_anew = 0;
    for (int frame = 0; frame < 1500; ++frame) {
      for (std::size_t n = 0; n < 40; ++n) {
        const std::size_t k = wander ? (40 * static_cast<std::size_t>(frame) + n) % 2000 : 50 * n;
        for (int axis = 0; axis < 3; ++axis) {
          const float by = wander ? random.uniform(-0.01f, 0.01f) : frame % 2 ? 0.01f : -0.01f;
          boxes[k].lo[axis] += by, boxes[k].hi[axis] += by;
        }
      }
      const auto pairs = blocks.overlapping(boxes);
      if (frame % 100 == 99) {
        ASSERT_EQ(sorted(pairs), pairs_by_definition<Closed>(boxes)) << "frame " << frame;
      }
      changed += blocks.reason().starts_with("changed");
      sorted_anew += blocks.reason().ends_with("sorted anew");
    }
    EXPECT_GT(changed, 1400u);
    if (wander) {
      EXPECT_GT(sorted_anew, 0u);
      EXPECT_LT(20 * sorted_anew, changed);
    } else {
      EXPECT_EQ(sorted_anew, 0u);
    }
  }
}

}  // namespace
}  // namespace bvlab
