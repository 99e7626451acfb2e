// SPDX-License-Identifier: BSD-3-Clause
/// What the talk says of its separation list, held to the number.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <random>
#include <tuple>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "tests/types_of.hpp"
#include "traversal/bodies.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

static_assert(std::is_empty_v<NotCounting>);

/// Bodies of one volume, asked by the loops of the program.
template <class V>
class AskedBodies {
 public:
  AskedBodies(std::span<const TriangleMesh> meshes, std::size_t bodies, std::uint32_t fan_out = 2,
              Frame frame = Frame::world) {
    Variant variant;
    variant.build = builds::TopDownPrincipal::name, variant.fan_out = fan_out;
    hierarchies_ = volume_entry(V::name).hierarchies(meshes, variant);
    const auto make = [&]<class Query>(std::optional<AnyBodies<Query>>& of_query) {
      of_query.emplace(bodies_entry<Query>(V::name).bodies(*hierarchies_, bodies, frame));
    };
    std::apply([&](auto&... of_query) { (make(of_query), ...); }, all_);
  }

  const Hierarchy<V>& hierarchy() const {
    return static_cast<const HierarchiesOf<V>&>(*hierarchies_)[0];
  }
  void move(std::size_t i, const Pose& pose) {
    std::apply([&](auto&... bodies) { (bodies->move(i, pose, Vec3<double>::Zero()), ...); }, all_);
  }
  template <class Strategy, class Query>
  void run(Strategy&& strategy, const ObjectPair& pair, Query& query, Counting& counter) {
    auto& bodies = *std::get<std::optional<AnyBodies<Query>>>(all_);
    strategy.run(bodies.pair(pair, query, counter));
  }

 private:
  std::unique_ptr<AnyHierarchies> hierarchies_;
  std::tuple<std::optional<AnyBodies<Touching>>, std::optional<AnyBodies<Contacts>>,
             std::optional<AnyBodies<Distance>>>
      all_;
};

template <class V>
class FrontLaws : public ::testing::Test {
 protected:
  TriangleMesh mesh_ = formula_mesh("star", 120);
  std::optional<AskedBodies<V>> bodies_{std::in_place, std::span(&mesh_, 1), 4};

  template <class Strategy, class Query>
  void run(Strategy&& strategy, Query& query, Counting& counter) {
    bodies_->run(strategy, {0, 1}, query, counter);
  }

  /// All contacts that a strategy finds, sorted.
  template <class Strategy>
  std::vector<Contact> contacts(Strategy&& strategy, Counting& counter) {
    std::vector<Contact> found;
    Contacts query(found);
    run(strategy, query, counter);
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Of the same mesh, from now on.
  void use(std::uint32_t fan_out, Frame frame) {
    bodies_.emplace(std::span(&mesh_, 1), 4, fan_out, frame);
  }

  void place(const Pose& a, const Pose& b) { bodies_->move(0, a), bodies_->move(1, b); }

  /// Leaves below a node, by their primitives' places.
  void leaves(std::uint32_t node, std::vector<std::uint32_t>& places) const {
    const auto& n = bodies_->hierarchy().node(node);
    if (n.count) places.push_back(n.first);
    for (std::uint32_t k = 0; k < n.children; ++k) leaves(n.first + k, places);
  }

  /// Every pair of leaves below exactly one entry.
  template <class AnyFront>
  void expect_partition(const AnyFront& front, std::string_view whose) const {
    std::vector<int> covered(mesh_.triangles.size() * mesh_.triangles.size(), 0);
    for (const auto& [a, b] : front.entries()) {
      std::vector<std::uint32_t> of_a, of_b;
      leaves(a, of_a), leaves(b, of_b);
      for (const auto i : of_a)
        for (const auto j : of_b) ++covered[i * mesh_.triangles.size() + j];
    }
    EXPECT_TRUE(std::all_of(covered.begin(), covered.end(), [](int n) { return n == 1; })) << whose;
  }
};
TYPED_TEST_SUITE(FrontLaws, TypesOf<Volumes>);

Pose at(double x, double angle = 0) {
  return *pose_from({x, 0.1, 0.2}, std::cos(angle / 2), 0.3 * std::sin(angle / 2),
                    0.5 * std::sin(angle / 2), std::sqrt(0.66) * std::sin(angle / 2));
}

TYPED_TEST(FrontLaws, BodiesThatStayCostOneTestForEachEntry) {
  // Near, but apart: both boxes overlap, no triangles do.
  for (const double x : {0.0, 1.3, 1.6, 5.0}) {
    this->place(Pose{}, at(x, 0.7));
    Counting recursive, first, later, last;
    std::vector<Contact> found;
    Contacts query(found);
    this->run(Recursive(), query, recursive);
    Deferred deferred(1);
    this->run(deferred, query, first);
    const std::uint64_t n = deferred.front_size();
    EXPECT_EQ(recursive.n_v, 2 * n - 1);
    EXPECT_EQ(first.n_v, 2 * n - 1);
    for (int run = 0; run < 2; ++run) {  // 1 + k runs without growth are let pass
      Counting still;
      this->run(deferred, query, still);
      EXPECT_EQ(still.n_v, n);
      EXPECT_EQ(still.n_u, 0u);
      EXPECT_EQ(still.n_p, recursive.n_p);
    }
    Counting rebuilt;
    this->run(deferred, query, rebuilt);
    EXPECT_EQ(rebuilt.n_v, 2 * n - 1);
    EXPECT_EQ(deferred.front_size(), n);
  }
}

TYPED_TEST(FrontLaws, DeferringByKSpreadsARebuildOverKPlusTwoRuns) {
  this->place(Pose{}, at(1.6));
  for (const unsigned k : {0u, 1u, 5u}) {
    Counting counter;
    std::vector<Contact> found;
    Contacts query(found);
    Deferred deferred(k);
    for (unsigned run = 0; run < 10 * (k + 2); ++run) this->run(deferred, query, counter);
    const std::uint64_t n = deferred.front_size();
    EXPECT_EQ(counter.n_v, 10 * ((2 * n - 1) + (k + 1) * n));
  }
}

/// A recursion over a front of n entries opens pairs, each into at most F: the entries are what is
/// not opened, so it makes between n + (n - 1) / (F - 1) and 2n - 1 tests, and a list saves
/// bodies that stay all but n.
TYPED_TEST(FrontLaws, AListSavesLessTheWiderTheTree) {
  for (const std::uint32_t fan_out : {2u, 4u, 16u})
    for (const Frame frame : {Frame::world, Frame::body}) {
      this->use(fan_out, frame);
      ASSERT_LE(this->bodies_->hierarchy().fan_out(), fan_out);
      this->place(Pose{}, at(1.3, 0.7));
      std::vector<Contact> found;
      Contacts query(found);
      Counting recursive, first, still;
      this->run(Recursive(), query, recursive);
      Deferred deferred(1);
      this->run(deferred, query, first);
      this->run(deferred, query, still);
      const std::uint64_t n = deferred.front_size();
      EXPECT_EQ(first.n_v, recursive.n_v);
      EXPECT_EQ(still.n_v, n);
      EXPECT_EQ(still.n_p, first.n_p);
      EXPECT_GE(recursive.n_v, n + (n - 1) / (fan_out - 1));
      EXPECT_LE(recursive.n_v, 2 * n - 1);
      EXPECT_EQ(still.n_u, frame == Frame::body ? n : 0);
      this->expect_partition(deferred.front(), "deferred");
    }
}

TYPED_TEST(FrontLaws, EveryFrontIsAPartitionOnTreesOfEveryFanOut) {
  for (const std::uint32_t fan_out : {4u, 8u, 16u}) {
    this->use(fan_out, fan_out == 8 ? Frame::world : Frame::body);
    Strategies::for_each([&]<class Strategy>(std::type_identity<Strategy>) {
      if constexpr (requires(const Strategy& strategy) { strategy.front().entries(); }) {
        std::mt19937_64 random(fan_out);
        std::uniform_real_distribution<double> anywhere(-2, 2), step(-0.05, 0.05);
        Strategy strategy;
        Counting counter;
        double x = 0, angle = 0;
        for (int frame = 0; frame < 100; ++frame) {
          x = frame % 20 ? x + step(random) : anywhere(random);
          angle += step(random);
          this->place(Pose{}, at(x, angle));
          Touching query;
          this->run(strategy, query, counter);
          if (strategy.front_size() > 0) this->expect_partition(strategy.front(), Strategy::name);
        }
      }
    });
  }
}

TYPED_TEST(FrontLaws, AFrontRisesToTheRootsWhenBodiesPart) {
  for (const std::uint32_t fan_out : {2u, 4u, 16u}) {
    this->use(fan_out, Frame::world);
    Counting counter;
    std::vector<Contact> found;
    Contacts query(found);
    Raise raise;
    this->place(Pose{}, at(1.3, 0.7));
    for (int run = 0; run < 10; ++run) this->run(raise, query, counter);
    EXPECT_GT(raise.front_size(), 10u);
    for (int run = 0; run < 400; ++run) {
      this->place(Pose{}, at(1.3 + 0.02 * run, 0.7));
      this->run(raise, query, counter);
    }
    EXPECT_EQ(raise.front_size(), 1u);
  }
}

/// Every strategy of the list that shows a front, whatever it is made with.
TYPED_TEST(FrontLaws, TheFrontStaysAPartitionWhateverCutsARunShort) {
  int shown = 0;
  Strategies::for_each([&]<class Strategy>(std::type_identity<Strategy>) {
    if constexpr (requires(const Strategy& strategy) { strategy.front().entries(); }) {
      ++shown;
      std::mt19937_64 random(7);
      std::uniform_real_distribution<double> anywhere(-2, 2), angle(0, 6);
      Strategy strategy;
      Counting counter;
      int hits = 0;
      constexpr int frames = 150;
      for (int frame = 0; frame < frames; ++frame) {
        this->place(at(anywhere(random), angle(random)), at(anywhere(random), angle(random)));
        Touching query;
        this->run(strategy, query, counter);
        hits += query.touching();
        // A strategy may go without a front for a while.
        if (strategy.front_size() > 0) this->expect_partition(strategy.front(), Strategy::name);
      }
      EXPECT_GT(hits, frames / 10) << Strategy::name;
      EXPECT_LT(hits, frames * 9 / 10) << Strategy::name;
    }
  });
  EXPECT_GE(shown, 5);
}

/// A strategy asked in turn about two pairs of bodies, each with a query of its own, gives up what
/// it measured whenever the query changes. The pairs rotate at different speeds, so that its sums
/// over frames fall from one run to the next.
TYPED_TEST(FrontLaws, NoVerdictOfOtherBodiesIsReused) {
  Strategies::for_each([&]<class Strategy>(std::type_identity<Strategy>) {
    Strategy strategy;
    Counting counter;
    std::size_t contacts = 0;
    for (int frame = 0; frame < 100; ++frame) {
      const double x = 1.3 - 0.002 * frame;
      this->place(Pose{}, at(x, 0.7 + 0.002 * frame));
      this->bodies_->move(2, at(0, 0.7 * frame));
      this->bodies_->move(3, at(x, 0.5));
      const std::vector<Contact> found = this->contacts(strategy, counter);
      ASSERT_EQ(found, this->contacts(Recursive(), counter))
          << Strategy::name << " in frame " << frame;
      contacts += found.size();
      Touching one, from_roots;
      this->bodies_->run(strategy, {2, 3}, one, counter);
      this->bodies_->run(Recursive(), {2, 3}, from_roots, counter);
      ASSERT_EQ(one.touching(), from_roots.touching()) << Strategy::name << " in frame " << frame;
    }
    EXPECT_GT(contacts, 100u);
  });
}

/// In fast motion few gaps last and margins stop measuring them; in slow motion and at rest they
/// begin again.
TYPED_TEST(FrontLaws, OnlyGapsThatLastAreMeasured) {
  Margins margins, touching;
  Counting counter;
  std::size_t contacts = 0;
  std::array<int, 2> runs_that_measured{};  // fast, slow
  double angle = 0;
  for (int frame = 0; frame < 180; ++frame) {
    const bool slow = frame / 60 % 2 == 1;
    angle += slow ? 1e-5 : 0.6;
    this->place(Pose{}, at(slow ? 0.8 : 0.6 + 0.4 * (frame % 5), angle));
    const std::vector<Contact> expected = this->contacts(Recursive(), counter);
    for (int runs = 0; runs < (frame % 13 == 12 ? 3 : 1); ++runs) {  // also at rest
      ASSERT_EQ(this->contacts(margins, counter), expected)
          << "in frame " << frame << ", run " << runs;
      Touching yes_or_no;
      this->run(touching, yes_or_no, counter);
      ASSERT_EQ(yes_or_no.touching(), !expected.empty()) << "in frame " << frame;
      if (runs > 0) continue;
      std::size_t known = 0;
      for (std::size_t slot = 0; slot < margins.front_size(); ++slot)
        known += margins.front().gap(slot) > 0;
      runs_that_measured[slow] += 2 * known > margins.front_size();
    }
    contacts += expected.size();
    this->expect_partition(margins.front(), "margins");
  }
  EXPECT_GT(contacts, 100u);
  EXPECT_LT(runs_that_measured[0], 40);
  EXPECT_GT(runs_that_measured[1], 50);
}

/// Beside large triangles margins open the small nodes, and only where that widens gaps.
TYPED_TEST(FrontLaws, LargeTrianglesDoNotLengthenFrontsOfMargins) {
  std::array<TriangleMesh, 2> meshes{TriangleMesh{}, this->mesh_};
  TriangleMesh& ground = meshes[0];
  ground.vertices = {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}};
  ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  AskedBodies<TypeParam> bodies(meshes, 2);
  bodies.move(0, Pose{});
  Margins margins;
  SeparationList list;
  std::size_t of_margins = 0, of_list = 0;
  Counting counter;
  for (int frame = 0; frame < 200; ++frame) {
    Pose pose = at(0.1 * frame, 0.1 * frame);
    pose.translation[2] = 1.2 + 0.3 * std::sin(0.1 * frame);
    bodies.move(1, pose);
    const auto touching = [&](auto&& strategy) {
      Touching query;
      bodies.run(strategy, {0, 1}, query, counter);
      return query.touching();
    };
    const bool expected = touching(Recursive());
    ASSERT_EQ(touching(margins), expected) << "in frame " << frame;
    ASSERT_EQ(touching(list), expected) << "in frame " << frame;
    of_margins += margins.front_size(), of_list += list.front_size();
  }
  EXPECT_LT(of_margins, 4 * of_list);
}

/// A query that one hit ends and that says which.
class FirstHit : public Touching {
 public:
  static constexpr std::string_view name = "first-hit";
  Contact hit{};

  Outcome primitives(std::span<const Candidate> pending) {
    return kept(Touching::primitives(pending), pending);
  }
  Outcome primitives(std::span<const Candidate> pending, std::span<Verdict> verdicts) {
    return kept(Touching::primitives(pending, verdicts), pending);
  }
  bool known(std::uint32_t a, std::uint32_t b) {
    hit = {a, b};
    return Touching::known(a, b);
  }
  void answer() const = delete;  // of this query yes is not the whole answer

 private:
  Outcome kept(const Outcome& outcome, std::span<const Candidate> pending) {
    if (outcome.satisfied) hit = {pending[outcome.witness].a, pending[outcome.witness].b};
    return outcome;
  }
};

TYPED_TEST(FrontLaws, MarginsRepeatAHitThatStillTouches) {
  Body<TypeParam> a(this->mesh_, this->bodies_->hierarchy()), b(this->mesh_, a.hierarchy());
  a.move(Pose{}, Vec3<double>::Zero());
  Workspace workspace;
  for (const double step : {0.001, 0.004, 0.02}) {
    Margins margins;
    Counting counter;
    std::size_t quiet = 0;
    for (int frame = 0; frame < 400; ++frame) {
      const Pose pose = at(0.5 + 0.3 * std::sin(step * frame), step * frame);
      this->place(Pose{}, pose);
      b.move(pose, Vec3<double>::Zero());
      std::vector<Contact> contacts;
      Contacts all(contacts);
      this->run(Recursive(), all, counter);
      FirstHit query;
      Counting counted;
      margins.run(BodyPair<NativeBatch<typename TypeParam::scalar>, TypeParam, FirstHit, Counting>(
          a, b, query, counted, workspace));
      ASSERT_EQ(query.touching(), !contacts.empty()) << frame;
      if (!query.touching()) continue;
      quiet += counted.n_v + counted.n_p == 0;
      EXPECT_EQ(std::count(contacts.begin(), contacts.end(), query.hit), 1) << frame;
    }
    EXPECT_GT(quiet, step < 0.01 ? 50u : 0u);
  }
}

/// Matrices that are no rotations enlarge a body, and the sphere about its origin with it: two tips
/// that meet only where both are enlarged.
TYPED_TEST(FrontLaws, SpheresOfEnlargedBodiesAreEnlarged) {
  Vec3<double> tip = Vec3<double>::Zero();
  for (const auto& vertex : this->mesh_.vertices)
    if (vertex.norm() > tip.norm()) tip = vertex;
  const auto towards = [&](double x) {
    return Eigen::Quaterniond::FromTwoVectors(tip, Vec3<double>(x, 0, 0)).toRotationMatrix();
  };
  for (const double scale : {1.0 + 1e-5, 1.001, 1.004, 1.3}) {
    Pose a, b;
    a.rotation = scale * towards(1), b.rotation = scale * towards(-1);
    Strategies::for_each([&]<class Strategy>(std::type_identity<Strategy>) {
      Strategy strategy;
      Counting counter;
      std::size_t touching = 0;
      for (int frame = 0; frame < 60; ++frame) {
        b.translation[0] = 2 * tip.norm() * (1 + (scale - 1) * (frame / 3 % 2 ? 0.3 : 1.5));
        this->place(a, b);
        Touching query, from_roots;
        this->run(strategy, query, counter);
        this->run(Recursive(), from_roots, counter);
        EXPECT_EQ(query.touching(), from_roots.touching()) << Strategy::name << ' ' << scale;
        touching += from_roots.touching();
      }
      EXPECT_EQ(touching, 30u);
    });
  }
}

/// Bodies that have never moved and bodies that stop after jumps, which keep nothing of use.
TYPED_TEST(FrontLaws, AdaptiveTestsContactsAtRestNoMore) {
  for (const int jumps : {0, 40}) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> anywhere(-2, 2);
    Adaptive adaptive;
    for (int run = 0; run <= jumps + 400; ++run) {
      if (run < jumps)
        this->place(Pose{}, at(anywhere(random), anywhere(random)));
      else if (run == jumps)
        this->place(Pose{}, at(0.8, 0.7));
      Counting counter, from_roots;
      const std::vector<Contact> found = this->contacts(adaptive, counter);
      if (run < jumps + 400) continue;
      EXPECT_EQ(found, this->contacts(Recursive(), from_roots));
      EXPECT_GT(found.size(), 10u);
      EXPECT_EQ(counter.n_v, 0u) << jumps;
      EXPECT_EQ(counter.n_p, 0u) << jumps;
      EXPECT_GT(from_roots.n_p, 0u);
    }
  }
}

TYPED_TEST(FrontLaws, ARisingFrontStaysAPartitionWhateverIsRaised) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> anywhere(-2, 2), step(-0.02, 0.02);
  Raise raise;
  Counting counter;
  std::vector<Contact> found;
  int partial = 0;
  double x = 0, angle = 0;
  for (int frame = 0; frame < 400; ++frame) {
    // Small steps and, now and then, a jump.
    x = frame % 40 ? x + step(random) : anywhere(random);
    angle += step(random);
    this->place(Pose{}, at(x, angle));
    Touching touching;
    Contacts contacts(found);
    if (frame % 3)
      this->run(raise, touching, counter);
    else
      this->run(raise, contacts, counter);
    if (raise.front().empty()) continue;  // dropped: it does not pay now
    this->expect_partition(raise.front(), Raise::name);
    partial += touching.touching();
  }
  EXPECT_GT(partial, 20);
}

TYPED_TEST(FrontLaws, AFrontAtRestTriesParentsLessAndLess) {
  for (const double x : {0.0, 1.3, 1.6}) {
    this->place(Pose{}, at(x, 0.7));
    std::vector<Contact> found;
    Contacts query(found);
    Raise raise;
    Counting first;
    this->run(raise, query, first);
    const std::uint64_t n = raise.front_size();
    EXPECT_EQ(first.n_v, 2 * n - 1);
    for (int run = 1; run <= 96; ++run) {
      Counting still;
      this->run(raise, query, still);
      EXPECT_EQ(still.n_p, first.n_p);
      EXPECT_LE(still.n_v, n + n / 2);
      EXPECT_GE(still.n_v, n);
      // From then on all wait for the longest time.
      if (run > 32 && (run + 1) % 16) {
        EXPECT_EQ(still.n_v, n);
      }
    }
    EXPECT_EQ(raise.front_size(), n);
  }
}

TYPED_TEST(FrontLaws, AHitIsTheFirstToBeTestedNextTime) {
  this->place(Pose{}, at(0.2, 0.5));
  Deferred deferred(1);
  Counting first, again;
  Touching one, two;
  this->run(deferred, one, first);
  this->run(deferred, two, again);
  EXPECT_TRUE(one.touching() && two.touching());
  EXPECT_EQ(again.n_p, 1u);
  EXPECT_EQ(again.n_v, 1u);
}

TYPED_TEST(FrontLaws, AWitnessDecidesBeforeAnyVolumeIsTested) {
  this->place(Pose{}, at(0.2, 0.5));
  Witness witness;
  Counting first, again, other;
  Touching one, two;
  this->run(witness, one, first);
  this->run(witness, two, again);
  EXPECT_TRUE(one.touching() && two.touching());
  EXPECT_GT(first.n_v, 0u);
  EXPECT_EQ(again.n_v, 0u);
  EXPECT_EQ(again.n_u, 0u);
  EXPECT_EQ(again.n_p, 1u);
  // All contacts are sought from the roots, each found once, and so is an answer after them.
  const std::vector<Contact> expected = this->contacts(RecursiveBoth(), other);
  EXPECT_EQ(this->contacts(witness, other), expected);
  this->place(Pose{}, at(9));
  Touching apart;
  this->run(witness, apart, other);
  EXPECT_FALSE(apart.touching());
}

TYPED_TEST(FrontLaws, TheLastNearestLeavesSpareTestsOfDistances) {
  std::uint64_t from_roots = 0, with_witness = 0;
  Witness witness;
  for (int frame = 0; frame < 40; ++frame) {
    this->place(Pose{}, at(2.4 + 0.01 * frame, 0.02 * frame));
    Counting roots, kept;
    Distance expected, found;
    this->run(RecursiveBoth(), expected, roots);
    this->run(witness, found, kept);
    EXPECT_NEAR(found.distance(), expected.distance(), 0x1p-45 * expected.distance()) << frame;
    if (frame > 0) from_roots += roots.n_v, with_witness += kept.n_v;
  }
  EXPECT_LT(with_witness, from_roots);
}

/// Entries are found by their pairs whichever was a witness: siblings are proposed as often as in a
/// front in which nothing ever moved, and a table that lost track would fill up.
TEST(RisingFronts, WitnessesComeAndGo) {
  const TriangleMesh mesh = formula_mesh("star", 400);
  const Hierarchy<Sphere<float>> hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  RisingFront front;
  front.restart();
  // All children of all inner nodes of b, with the root of a: a front as deep as the tree.
  for (std::size_t slot = 0; slot < front.size(); ++slot) {
    const auto node = hierarchy.node(front[slot].b);
    if (node.count > 0 || front.size() > 200) continue;
    front.open(slot);
    front.add({0, node.first});
    front.add({0, node.first + 1});
    --slot;
  }
  const std::size_t n = front.size();
  std::mt19937_64 random(3);
  for (int i = 0; i < 20000; ++i) front.set_witness(random() % n);
  Proposals proposals;
  front.propose(hierarchy, hierarchy, proposals);
  std::size_t siblings = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      siblings += (front[i].b + 1) / 2 == (front[j].b + 1) / 2;
  EXPECT_GT(siblings, 50u);
  EXPECT_EQ(proposals.all.size(), siblings);
}

/// A body of radius 1 about its origin.
class Ball : public MovingBody {
 public:
  Ball() : MovingBody({.radius = 1, .reach = 1, .nodes = 1, .leaves = 1}) { move_to(0); }
  void move_to(double x) {
    Pose pose;
    pose.translation[0] = x;
    set_pose(pose, Vec3<double>::Zero());
  }
};

/// Every slot once and no other, however full the last register is: also where all are due for
/// ever, as they are to a query without a limit. What is collected stays due until it is measured
/// again, and groups of entries that are passed over lose as much of their gaps as the others.
TEST(MarginFronts, CollectWhatIsDue) {
  for (std::size_t n = 1; n < 70; ++n) {
    Ball a, b;
    MarginFront front;
    std::vector<std::uint32_t> buffer;
    std::array<NodeSphere, 2> spheres{};
    spheres[1].radius = 1e-6f;
    const auto measure_all = [&] {
      PresentPoses now(a, b);
      for (std::size_t i = 0; i < n; ++i) front.announce_gap(i, static_cast<float>(i));
      front.measure(now, {spheres.data(), spheres.data()}, 0);
    };
    // The smaller sphere is that of a, and of b, by turns.
    for (std::uint32_t i = 0; i < n; ++i) front.add({i % 2, 1 - i % 2});
    measure_all();
    const auto expect_due = [&](double time, double limit) {
      PresentPoses now(a, b);
      const MarginFront::Due due = front.collect(now, limit, buffer);
      const auto passed = static_cast<std::size_t>(std::clamp(time + 1, 0.0, double(n)));
      ASSERT_EQ(due.slots.size(), passed) << n << " entries at " << time;
      for (std::size_t i = 0; i < passed; ++i) ASSERT_EQ(due.slots[i], i);
      if (passed < n && limit == 0) {
        EXPECT_LE(due.least_of_others, static_cast<double>(passed) - time);
        EXPECT_GE(due.least_of_others, static_cast<double>(passed) - time - 1e-3);
      }
      for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(front.gap(i) > 0, i >= passed);
    };
    for (const double limit : {0.0, n / 2.0, 1e3, std::numeric_limits<double>::infinity()}) {
      expect_due(limit, limit);
      measure_all();
    }
    for (const double x : {0.25, 0.75, 1.5, 6.25, 40.5}) {
      b.move_to(x);
      expect_due(x, 0);
    }
    b.move_to(0.5);  // a sphere that came back is as far as it was, but what was forgotten is due
    PresentPoses now(a, b);
    EXPECT_EQ(front.collect(now, 0, buffer).slots.size(), std::min<std::size_t>(n, 41));
  }
}

/// measure() makes known the least value announced for each entry. An entry is unknown before, if
/// it was forgotten, and if its volumes' gap is below `useful`.
TEST(MarginFronts, MeasureWhatWasAnnounced) {
  Ball a, b;
  MarginFront front;
  const NodeSphere point{};
  for (int i = 0; i < 40; ++i) front.add({0, 0});
  front.announce_gap(0, 1);
  front.announce_gap(1, 0.25f);  // not useful
  front.announce_gap(17, 2);
  front.forget_gap(17);
  front.announce_triangles(18);
  front.lower_gap(18, 0.25f);  // of triangles: kept
  front.lower_gap(18, 3);
  front.announce_triangles(39);
  front.lower_gap(39, std::numeric_limits<float>::quiet_NaN());
  for (const std::size_t slot : {0u, 1u, 17u, 18u, 39u}) EXPECT_FALSE(front.gap(slot) > 0);
  PresentPoses now(a, b);
  EXPECT_EQ(front.measure(now, {&point, &point}, 0.5f), 0);
  for (std::size_t slot = 0; slot < front.size(); ++slot) {
    const double gap = slot == 0 ? 1 : slot == 18 ? 0.25 : 0;
    EXPECT_LE(front.gap(slot), gap) << slot;
    EXPECT_EQ(front.gap(slot) > 0.99 * gap, gap > 0) << slot;
  }
  front.announce_gap(2, 0.75f);
  front.announce_triangles(0);  // known before
  front.lower_gap(0, 0.875f);
  EXPECT_FALSE(front.gap(0) > 0);
  EXPECT_NEAR(front.measure(now, {&point, &point}, 0.5f), 0.75, 1e-5);
  EXPECT_EQ(front.measure(now, {&point, &point}, 0.5f), std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace bvlab
