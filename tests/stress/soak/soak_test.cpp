// SPDX-License-Identifier: BSD-3-Clause
/// Coherent equals fresh, for ever: one pair of bodies for a very long time, every strategy beside
/// recursion in every frame; and one strategy asked now this, now that.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "tests/stress/soak/way.hpp"
#include "tests/types_of.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

/// The two bodies under one query, with the loops that are compiled into the program.
template <class Query>
class Both {
 public:
  explicit Both(const AnyHierarchies& hierarchies)
      : bodies_(bodies_entry<Query>("sphere").bodies(hierarchies, 2, Frame::world)) {}

  void move(const Pose& first, const Pose& second) {
    bodies_.move(0, first, Vec3<double>::Zero());
    bodies_.move(1, second, Vec3<double>::Zero());
  }
  template <class Strategy>
  void run(Strategy& strategy, Query& query) {
    strategy.run(bodies_.pair(pair_, query, counter_));
  }

 private:
  AnyBodies<Query> bodies_;
  const ObjectPair pair_{0, 1};
  NotCounting counter_;
};

template <class Strategy>
class Soak : public ::testing::Test {
 protected:
  const std::vector<TriangleMesh> meshes_{formula_mesh("star", 60), formula_mesh("torus", 64)};
  const std::unique_ptr<AnyHierarchies> trees_ = [this] {
    Variant variant;
    variant.leaf_size = 2;
    return volume_entry("sphere").hierarchies(meshes_, variant);
  }();
  Both<Contacts> for_contacts_{*trees_};
  Both<Touching> for_touching_{*trees_};
  Both<Distance> for_distance_{*trees_};

  void move(const Pose& first, const Pose& second) {
    for_contacts_.move(first, second);
    for_touching_.move(first, second);
    for_distance_.move(first, second);
  }
  template <class S>
  std::vector<Contact> contacts(S& strategy) {
    std::vector<Contact> found;
    Contacts query(found);
    for_contacts_.run(strategy, query);
    std::sort(found.begin(), found.end());
    return found;
  }
  template <class S>
  bool touching(S& strategy) {
    Touching query;
    for_touching_.run(strategy, query);
    return query.touching();
  }
  template <class S>
  double distance(S& strategy) {
    Distance query;
    for_distance_.run(strategy, query);
    return query.distance();
  }
};
TYPED_TEST_SUITE(Soak, TypesOf<Strategies>);

TYPED_TEST(Soak, CoherentEqualsFresh) {
  const std::size_t frames = soak_frames(20000);
  Way way;
  Recursive fresh;
  TypeParam for_contacts, for_touching, for_distance, for_any;
  std::size_t hits = 0, early = 0, late = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    way.step();
    this->move(way.first(), way.second());
    const auto truth = this->contacts(fresh);
    hits += !truth.empty();
    ASSERT_EQ(this->contacts(for_contacts), truth) << "frame " << frame;
    ASSERT_EQ(this->touching(for_touching), !truth.empty()) << "frame " << frame;
    // A tenth of the way for what takes longest.
    if (frame < frames / 10) {
      const double distance = this->distance(fresh);
      ASSERT_NEAR(this->distance(for_distance), distance, 1e-12 * distance) << "frame " << frame;
      // One strategy may be asked anything, and not in every frame.
      if (frame % 3 == 0) {
        ASSERT_EQ(this->contacts(for_any), truth) << "frame " << frame;
      } else if (frame % 7 == 0) {
        ASSERT_EQ(this->touching(for_any), !truth.empty()) << "frame " << frame;
      } else if (frame % 11 == 0) {
        ASSERT_NEAR(this->distance(for_any), distance, 1e-12 * distance) << "frame " << frame;
      }
    }
    // A front is no larger than the pairs of leaves, of which lists keep one each at most.
    const std::size_t front = std::max(for_contacts.front_size(), for_touching.front_size());
    ASSERT_LE(front, 2 * this->meshes_[0].triangles.size() * this->meshes_[1].triangles.size());
    (frame < frames / 2 ? early : late) += front;
  }
  EXPECT_GT(hits, frames / 20);
  EXPECT_LT(hits, frames - frames / 20);
  // Nor does it grow for ever.
  EXPECT_LE(late, 2 * early + 100 * frames);
}

}  // namespace
}  // namespace bvlab
