// SPDX-License-Identifier: BSD-3-Clause
/// Coherent equals fresh, for ever: one pair of bodies for a very long time, every strategy beside
/// recursion in every frame; and one strategy asked now this, now that.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/stress/soak/way.hpp"
#include "tests/types_of.hpp"
#include "traversal/bodies.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

using V = Sphere<float>;
using B = Batch<float, std::max(native_width<float>, 4)>;

template <class Strategy>
class Soak : public ::testing::Test {
 protected:
  TriangleMesh star_ = formula_mesh("star", 60), torus_ = formula_mesh("torus", 64);
  Hierarchy<V> star_tree_{star_, builds::TopDownPrincipal::topology(star_, 1)};
  Hierarchy<V> torus_tree_{torus_, builds::TopDownPrincipal::topology(torus_, 2)};
  Body<V> a_{star_, star_tree_}, b_{torus_, torus_tree_};
  Workspace workspace_;
  NotCounting counter_;

  template <class Query>
  BodyPair<B, V, Query, NotCounting> pair(Query& query) {
    return {a_, b_, query, counter_, workspace_};
  }
  template <class S>
  std::vector<Contact> contacts(S& strategy) {
    std::vector<Contact> found;
    Contacts query(found);
    strategy.run(pair(query));
    std::sort(found.begin(), found.end());
    return found;
  }
  template <class S>
  bool touching(S& strategy) {
    Touching query;
    strategy.run(pair(query));
    return query.touching();
  }
  template <class S>
  double distance(S& strategy) {
    Distance query;
    strategy.run(pair(query));
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
    this->a_.move(way.first(), Vec3<double>::Zero());
    this->b_.move(way.second(), Vec3<double>::Zero());
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
    ASSERT_LE(front, 2 * this->star_tree_.primitives() * this->torus_tree_.primitives());
    (frame < frames / 2 ? early : late) += front;
  }
  EXPECT_GT(hits, frames / 20);
  EXPECT_LT(hits, frames - frames / 20);
  // Nor does it grow for ever.
  EXPECT_LE(late, 2 * early + 100 * frames);
}

}  // namespace
}  // namespace bvlab
