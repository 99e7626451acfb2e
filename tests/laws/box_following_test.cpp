// SPDX-License-Identifier: BSD-3-Clause
/// `blocks` through motions that change without notice while boxes come and go, and how rarely it
/// begins to follow.
#include <gtest/gtest.h>

#include <array>

#include "broadphase/methods/blocks.hpp"
#include "tests/laws/boxes_for_test.hpp"

namespace bvlab {
namespace {

/// Boxes that move in one way after the other, each for some frames, drawn at random.
template <class T>
class Hostile {
 public:
  explicit Hostile(unsigned seed) : random_(seed), largest_(seed % 2 ? T(0.06) : T(0.2)) {
    while (boxes_.size() < 500) add();
  }
  const Frame<T>& boxes() const { return boxes_; }

  void step() {
    if (left_-- == 0) begin();
    ++step_;
    const int there_and_back = step_ % 20 < 10 ? step_ % 20 : 20 - step_ % 20;
    if (motion_ == one_through_all)
      boxes_[3] = {{T(step_ % 20) / 20, 0, 0}, {T(step_ % 20) / 20 + T(0.2), 1, 1}};
    const std::size_t every = motion_ == teleports ? (step_ == 1 ? 2 : 40)
                              : motion_ == few     ? 30
                                                   : 1;
    for (std::size_t k = motion_ == few ? random_.below(30) : 0; k < boxes_.size(); k += every) {
      if (motion_ == teleports || (motion_ == drift_and_jump && random_.below(300) == 0))
        boxes_[k] = some_box();
      else
        for (int axis = 0; axis < 3; ++axis) move(k, axis, there_and_back);
    }
    come_and_go();
  }

 private:
  enum Motion {
    one_through_all,
    to_one_point,
    breathe,
    teleports,
    reverse,
    jitter,
    stop_and_go,
    few,
    drift,
    drift_and_jump,
    motions
  };

  void begin() {
    motion_ = static_cast<Motion>(random_.below(motions));
    left_ = static_cast<int>(random_.below(random_.below(2) ? 20 : 90));
    resize_ = random_.below(3) == 0;
    speed_ = std::pow(T(10), random_.uniform(-4, T(-1.5)));
    step_ = 0;
    start_ = boxes_;
  }
  void move(std::size_t k, int axis, int there_and_back) {
    Box<T>& box = boxes_[k];
    const T start = k < start_.size() ? start_[k].lo[axis] : box.lo[axis];
    const T velocity = velocity_[k][static_cast<std::size_t>(axis)] * speed_;
    T by = 0;
    if (motion_ == to_one_point)
      by = start + (T(0.5) - start) * static_cast<T>(there_and_back) / 10 - box.lo[axis];
    if (motion_ == reverse) by = step_ / 5 % 2 ? -velocity : velocity;
    if (motion_ == jitter) by = start + random_.uniform(-1, 1) * speed_ - box.lo[axis];
    if (motion_ == stop_and_go && step_ % 5 == 0) by = velocity;
    if (motion_ == few || motion_ == drift || motion_ == drift_and_jump) by = velocity;
    if (std::abs(box.lo[axis] + by) > 20) by = 0;
    box.lo[axis] += by, box.hi[axis] += by;
    if (motion_ != breathe) return;
    const T half = (box.hi[axis] - box.lo[axis]) / 2, middle = box.lo[axis] + half;
    const T next = std::min(half * (step_ % 20 < 10 ? T(1.2) : 1 / T(1.2)), T(2));
    box.lo[axis] = middle - next, box.hi[axis] = middle + next;
  }
  void come_and_go() {
    if (random_.below(200) == 0) boxes_.resize(boxes_.size() / 2 + 100);
    if (resize_ && random_.below(3) == 0) {
      const unsigned count = random_.below(9);
      if (random_.below(2))
        boxes_.resize(boxes_.size() - count);
      else
        for (unsigned k = 0; k < count; ++k) add();
    }
    while (boxes_.size() < 100) add();
  }
  Box<T> some_box() { return random_.box(0, 1, T(0.01), largest_); }
  void add() {
    boxes_.push_back(some_box());
    while (velocity_.size() < boxes_.size())
      velocity_.push_back({random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)});
  }

  BoxMaker<T> random_;
  T largest_, speed_ = 0;
  Frame<T> boxes_, start_;
  std::vector<std::array<T, 3>> velocity_;
  Motion motion_ = drift;
  int left_ = 0, step_ = 0;
  bool resize_ = false;
};

template <class M>
class BoxFollowing : public ::testing::Test {};
using Followers = ::testing::Types<Blocks<float, Closed>, Blocks<double, HalfOpen>>;
TYPED_TEST_SUITE(BoxFollowing, Followers);

template <class Contact>
Contact contact_of(const Blocks<float, Contact>&);
template <class Contact>
Contact contact_of(const Blocks<double, Contact>&);

/// The list is brute force's and the changes are the difference, found out and told, by one thread
/// and by several.
TYPED_TEST(BoxFollowing, HostileMotionsWhileBoxesComeAndGo) {
  using T = typename TypeParam::Scalar;
  using Contact = decltype(contact_of(std::declval<TypeParam>()));
  for (unsigned seed = 1; seed <= 3; ++seed) {
    MethodSettings settings;
    settings.threads = seed == 3 ? 3 : 1;
    TypeParam quiet(settings);
    settings.changes = Changes::reported;
    TypeParam method(settings), told(settings);
    Hostile<T> hostile(seed);
    std::vector<Pair> before;
    Frame<T> last;
    for (int frame = 0; frame < 400; ++frame, last = hostile.boxes(), hostile.step()) {
      const Frame<T>& boxes = hostile.boxes();
      std::vector<std::uint32_t> moved;
      for (std::size_t k = 0; k < std::min(boxes.size(), last.size()); ++k)
        if (!(boxes[k] == last[k])) moved.push_back(static_cast<std::uint32_t>(k));
      const auto right = pairs_by_definition<Contact>(boxes);
      std::vector<Pair> began, ended;
      std::set_difference(right.begin(), right.end(), before.begin(), before.end(),
                          std::back_inserter(began));
      std::set_difference(before.begin(), before.end(), right.begin(), right.end(),
                          std::back_inserter(ended));
      const std::string what = "seed " + std::to_string(seed) + ", frame " + std::to_string(frame);
      ASSERT_EQ(sorted(quiet.overlapping(boxes)), right) << what;
      ASSERT_EQ(sorted(method.overlapping(boxes)), right) << what;
      ASSERT_EQ(sorted(told.update(boxes, moved)), right) << what << ", told";
      for (const TypeParam* each : {&method, &told}) {
        ASSERT_EQ(sorted(each->changes().began), began) << what;
        ASSERT_EQ(sorted(each->changes().ended), ended) << what;
      }
      before = right;
    }
  }
}

/// However boxes move, after two frames that begin to follow, another comes for 16 frames
/// that were followed, or 128 that were not.
TYPED_TEST(BoxFollowing, BeginsRarely) {
  using T = typename TypeParam::Scalar;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Hostile<T> hostile(seed);
    TypeParam method(MethodSettings{});
    double begun = 0, allowed = 2;
    for (int frame = 0; frame < 1000; ++frame, hostile.step()) {
      method.overlapping(hostile.boxes());
      const bool begins = method.reason() == "followed: new candidates for the frames to come";
      begun += begins;
      if (!begins) allowed += method.reason().starts_with("followed") ? 1.0 / 16 : 1.0 / 128;
      ASSERT_LE(begun, allowed) << "seed " << seed << ", frame " << frame;
    }
  }
}

/// Boxes that turn round or jitter leave what was made for steady ones once; then margins hold
/// them for good.
TYPED_TEST(BoxFollowing, MarginsHoldWhatTurns) {
  using T = typename TypeParam::Scalar;
  for (const bool jitter : {false, true}) {
    BoxMaker<T> random(5);
    const Frame<T> start = random.boxes(2000, 0, 1, T(0.01), T(0.05));
    Frame<T> boxes = start;
    TypeParam method(MethodSettings{});
    for (int frame = 0; frame < 300; ++frame) {
      method.overlapping(boxes);
      if (frame > 20) {
        ASSERT_TRUE(method.reason().starts_with("followed")) << "frame " << frame;
        ASSERT_EQ(method.reason().find("new"), std::string_view::npos) << "frame " << frame;
      }
      for (std::size_t k = 0; k < boxes.size(); ++k)
        for (int axis = 0; axis < 3; ++axis) {
          const T by = jitter ? random.uniform(T(-3e-4), T(3e-4))
                              : T(k % 3 == static_cast<std::size_t>(axis) ? 3e-4 : -2e-4) *
                                    T(frame % 8 < 4 ? frame % 8 : 8 - frame % 8);
          boxes[k].lo[axis] = start[k].lo[axis] + by, boxes[k].hi[axis] = start[k].hi[axis] + by;
        }
    }
  }
}

/// A box that comes and goes in every other frame leaves slots behind. They do not pile up: the
/// method starts over.
TYPED_TEST(BoxFollowing, StartsOverWhereTheNumberOfBoxesNeverSettles) {
  using T = typename TypeParam::Scalar;
  using Contact = decltype(contact_of(std::declval<TypeParam>()));
  BoxMaker<T> random(6);
  const Frame<T> start = random.boxes(1000, 0, 1, T(0.01), T(0.05));
  TypeParam method(MethodSettings{});
  int followed = 0, restarted = 0;
  for (int frame = 0; frame < 400; ++frame) {
    Frame<T> boxes = start;
    for (auto& box : boxes)
      for (int axis = 0; axis < 3; ++axis) {
        const T by = random.uniform(T(-3e-4), T(3e-4));
        box.lo[axis] += by, box.hi[axis] += by;
      }
    if (frame > 20 && frame % 2) boxes.push_back(random.box(0, 1, T(0.01), T(0.05)));
    const auto found = sorted(method.overlapping(boxes));
    if (frame % 40 < 2) ASSERT_EQ(found, pairs_by_definition<Contact>(boxes)) << frame;
    if (frame <= 20) continue;
    followed += method.reason().starts_with("followed");
    restarted += method.reason().starts_with("from scratch");
  }
  EXPECT_GT(followed, 100);
  EXPECT_GT(restarted, 0);
}

}  // namespace
}  // namespace bvlab
