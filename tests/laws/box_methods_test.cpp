// SPDX-License-Identifier: BSD-3-Clause
/// The laws of broad-phase methods, for every entry of the list, in float and double, closed and
/// half-open, coherent and not.
#include <gtest/gtest.h>

#include "broadphase/broadphase.hpp"
#include "tests/laws/boxes_for_test.hpp"

namespace bvlab {
namespace {

/// The least there is to a method: keeps the concept honest.
struct Fake {
  using Scalar = float;
  static constexpr std::string_view name = "fake";
  static constexpr std::string_view description = "finds nothing";
  explicit Fake(const MethodSettings&) {}
  std::span<const Pair> overlapping(Boxes<float>) { return {}; }
};
static_assert(BroadPhaseMethod<Fake>);
static_assert(!ReportsChanges<Fake>);

template <class List>
struct AsTypes;
template <class... Ms>
struct AsTypes<TypeList<Ms...>> {
  using type = ::testing::Types<Ms...>;
};

template <class M>
struct ContactOf;
template <template <class, class> class M, class T, class C>
struct ContactOf<M<T, C>> {
  using type = C;
};

template <class M>
class BoxMethod : public ::testing::Test {
 public:
  using T = typename M::Scalar;
  using Contact = typename ContactOf<M>::type;
  static_assert(BroadPhaseMethod<M>);

  static MethodSettings settings(Coherence coherence, Sort sort = Sort::radix) {
    MethodSettings s;
    s.coherence = coherence, s.sort = sort;
    s.changes = Changes::reported;
    s.cutoff = 8;  // so that small frames are divided
    return s;
  }

  /// Compares one frame with the definition, and the changes with the difference of two frames.
  static void check(M& method, const Frame<T>& frame, std::vector<Pair>& before,
                    const std::string& what) {
    const auto right = pairs_by_definition<Contact>(frame);
    const auto found = method.overlapping(frame);
    ASSERT_EQ(sorted(found), right) << M::name << ", " << what << ", " << frame.size() << " boxes";
    if constexpr (ReportsChanges<M>) {
      std::vector<Pair> began, ended;
      std::set_difference(right.begin(), right.end(), before.begin(), before.end(),
                          std::back_inserter(began));
      std::set_difference(before.begin(), before.end(), right.begin(), right.end(),
                          std::back_inserter(ended));
      ASSERT_EQ(sorted(method.changes().began), began) << M::name << ", began, " << what;
      ASSERT_EQ(sorted(method.changes().ended), ended) << M::name << ", ended, " << what;
    }
    before = right;
  }
};
TYPED_TEST_SUITE_P(BoxMethod);

TYPED_TEST_P(BoxMethod, EveryCaseFromScratch) {
  for (const Coherence coherence : {Coherence::off, Coherence::on})
    for (unsigned seed = 1; seed <= 3; ++seed)
      for (const auto& [name, boxes] : BoxMaker<typename TypeParam::Scalar>(seed).cases(150)) {
        TypeParam method(this->settings(coherence));
        std::vector<Pair> before;
        for (int twice = 0; twice < 2; ++twice) this->check(method, boxes, before, name);
        if (this->HasFatalFailure()) return;
      }
}

TYPED_TEST_P(BoxMethod, OneMethodThroughEveryCase) {
  for (const auto& [coherence, sort] :
       {std::pair{Coherence::off, Sort::radix}, std::pair{Coherence::on, Sort::radix},
        std::pair{Coherence::off, Sort::comparison}, std::pair{Coherence::on, Sort::comparison}}) {
    TypeParam method(this->settings(coherence, sort));
    std::vector<Pair> before;
    for (unsigned seed = 1; seed <= 2; ++seed)
      for (const auto& [name, boxes] : BoxMaker<typename TypeParam::Scalar>(seed).cases(100)) {
        this->check(method, boxes, before, name);
        if (this->HasFatalFailure()) return;
      }
  }
}

/// Every case moved for many frames: all of it, a part, by jumps, by growing, and not at all.
TYPED_TEST_P(BoxMethod, MovedForManyFrames) {
  using T = typename TypeParam::Scalar;
  for (const Coherence coherence : {Coherence::off, Coherence::on})
    for (auto& [name, boxes] : BoxMaker<T>(7).cases(90)) {
      if (name == "up to the largest number") continue;  // would move out of range
      BoxMaker<T> random(11);
      TypeParam method(this->settings(coherence));
      std::vector<Pair> before;
      for (int frame = 0; frame < 60; ++frame) {
        const int motion = frame / 10;
        const T step = motion == 0 ? 0 : motion == 1 ? T(1e-3) : motion == 2 ? T(0.02) : T(0.3);
        for (auto& box : boxes) {
          if (motion == 3 && random.below(10) != 0) continue;
          if (motion == 4 && random.below(20) == 0) box = random.box(0, 1, 0, T(0.2));
          for (int axis = 0; axis < 3; ++axis) {
            const T extent = box.hi[axis] - box.lo[axis];
            const T by = random.uniform(-1, 1) * step * (extent + T(1e-3));
            box.lo[axis] += by;
            box.hi[axis] = box.lo[axis] + extent;
            if (motion == 5) box.hi[axis] += std::abs(by);
          }
        }
        this->check(method, boxes, before, name + ", frame " + std::to_string(frame));
        if (this->HasFatalFailure()) return;
      }
    }
}

TYPED_TEST_P(BoxMethod, BoxesComeAndGo) {
  using T = typename TypeParam::Scalar;
  BoxMaker<T> random(3);
  TypeParam method(this->settings(Coherence::on));
  Frame<T> boxes = random.boxes(120, 0, 1, T(0.05), T(0.15));
  std::vector<Pair> before;
  for (int frame = 0; frame < 100; ++frame) {
    const unsigned what = random.below(5);
    if (what == 0) boxes.push_back(random.box(0, 1, 0, T(0.2)));
    if (what == 1 && !boxes.empty()) boxes.pop_back();
    if (what == 2 && !boxes.empty()) {  // the last takes the place of one that leaves
      boxes[random.below(static_cast<unsigned>(boxes.size()))] = boxes.back();
      boxes.pop_back();
    }
    if (what == 3 && !boxes.empty())
      boxes.erase(boxes.begin() + random.below(static_cast<unsigned>(boxes.size())));
    if (frame == 50) boxes.resize(3);
    if (frame == 60) boxes = random.boxes(300, 0, 1, T(0.05), T(0.15));
    for (auto& box : boxes)
      for (int axis = 0; axis < 3; ++axis) {
        const T by = random.uniform(T(-0.002), T(0.002));
        box.lo[axis] += by, box.hi[axis] += by;
      }
    this->check(method, boxes, before, "frame " + std::to_string(frame));
    if (this->HasFatalFailure()) return;
  }
}

/// Enough boxes for every level of every structure.
TYPED_TEST_P(BoxMethod, FiveThousandBoxes) {
  using T = typename TypeParam::Scalar;
  BoxMaker<T> random(5);
  Frame<T> boxes = random.boxes(5000, 0, 1, T(0.01), T(0.06));
  for (int k = 0; k < 40; ++k) boxes[k * 100] = random.box(0, 1, 0, k % 2 ? T(0.5) : T(1e-5));
  TypeParam method(this->settings(Coherence::on));
  std::vector<Pair> before;
  for (int frame = 0; frame < 6; ++frame) {
    for (auto& box : boxes)
      for (int axis = 0; axis < 3; ++axis) {
        const T by = random.uniform(-1, 1) * (frame == 3 ? T(0.2) : T(0.001));
        box.lo[axis] += by, box.hi[axis] += by;
      }
    this->check(method, boxes, before, "frame " + std::to_string(frame));
    if (this->HasFatalFailure()) return;
  }
}

REGISTER_TYPED_TEST_SUITE_P(BoxMethod, EveryCaseFromScratch, OneMethodThroughEveryCase,
                            MovedForManyFrames, BoxesComeAndGo, FiveThousandBoxes);

using Types = AsTypes<Methods<BVLAB_TEST_SCALAR, BVLAB_TEST_CONTACT>>::type;
INSTANTIATE_TYPED_TEST_SUITE_P(List, BoxMethod, Types);

}  // namespace
}  // namespace bvlab
