// SPDX-License-Identifier: BSD-3-Clause
/// Coherent equals fresh, for ever: one pair of bodies for a very long time, every strategy beside
/// recursion in every frame. BVLAB_SOAK_FRAMES says how long.
///
/// Speeds change over six orders of magnitude; there are stops of one body and of both, teleports,
/// and contacts. One body's quaternions have any length; the other's rotation is a product of all
/// the turns so far, never made orthonormal again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/types_of.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

using V = Sphere<float>;
using B = Batch<float, std::max(native_width<float>, 4)>;

std::size_t soak_frames() {
  const char* const text = std::getenv("BVLAB_SOAK_FRAMES");
  return text ? std::strtoul(text, nullptr, 10) : 20000;
}

/// Two bodies on a long way.
class Way {
 public:
  void step() {
    if (left_-- == 0) begin();
    if (happens(0.001)) position_ = Vec3<double>(anywhere(), anywhere(), anywhere());
    if (!first_stops_) {
      turn_ = (turn_ * small_turn()).normalized();
      position_ = (0.999 * position_ + speed_ * direction()).eval();
    }
    if (!second_stops_) {
      const double angle = speed_ / 2;
      const Vec3<double> axis = direction();
      const Pose turn = *pose_from(Vec3<double>::Zero(), std::cos(angle), std::sin(angle) * axis[0],
                                   std::sin(angle) * axis[1], std::sin(angle) * axis[2]);
      second_.rotation = (turn.rotation * second_.rotation).eval();
    }
  }

  Pose first() const {
    return *pose_from(position_, length_ * turn_.w(), length_ * turn_.x(), length_ * turn_.y(),
                      length_ * turn_.z());
  }
  const Pose& second() const { return second_; }

 private:
  void begin() {
    left_ = static_cast<int>(std::pow(10, 2.5 * unit_(random_)));
    speed_ = std::pow(10, -6 * unit_(random_));
    first_stops_ = happens(0.25), second_stops_ = happens(0.25);
    length_ = std::pow(10, 6 * unit_(random_) - 3);
  }
  bool happens(double probability) { return unit_(random_) < probability; }
  double anywhere() { return 3 * unit_(random_) - 1.5; }
  Vec3<double> direction() {
    return Vec3<double>(anywhere(), anywhere(), anywhere() + 1e-9).normalized();
  }
  Eigen::Quaterniond small_turn() {
    return Eigen::Quaterniond(Eigen::AngleAxisd(speed_ * unit_(random_), direction()));
  }

  std::mt19937_64 random_{42};
  std::uniform_real_distribution<double> unit_{0, 1};
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Vec3<double> position_{1, 0, 0};
  Pose second_;
  double speed_ = 0, length_ = 1;
  bool first_stops_ = false, second_stops_ = false;
  int left_ = 0;
};

template <class Strategy>
class Soak : public ::testing::Test {
 protected:
  TriangleMesh star_ = formula_mesh("star", 60), torus_ = formula_mesh("torus", 64);
  Hierarchy<V> star_tree_{star_, builds::TopDownPrincipal::topology(star_, 1)};
  Hierarchy<V> torus_tree_{torus_, builds::TopDownPrincipal::topology(torus_, 2)};
  Body<V> a_{star_, star_tree_}, b_{torus_, torus_tree_};
  Workspace workspace_;
  NotCounting counter_;

  template <class S>
  std::vector<Contact> contacts(S& strategy) {
    std::vector<Contact> found;
    Contacts query(found);
    strategy.template run<B>(a_, b_, query, counter_, workspace_);
    std::sort(found.begin(), found.end());
    return found;
  }
  template <class S>
  bool touching(S& strategy) {
    Touching query;
    strategy.template run<B>(a_, b_, query, counter_, workspace_);
    return query.touching();
  }
  template <class S>
  double distance(S& strategy) {
    Distance query;
    strategy.template run<B>(a_, b_, query, counter_, workspace_);
    return query.distance();
  }
};
TYPED_TEST_SUITE(Soak, TypesOf<Strategies>);

TYPED_TEST(Soak, CoherentEqualsFresh) {
  const std::size_t frames = soak_frames();
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
