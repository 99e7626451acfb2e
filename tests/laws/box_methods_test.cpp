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
static_assert(!TakesMoved<Fake>);
static_assert(TakesMoved<Blocks<float, Closed>> && TakesMoved<Auto<double, HalfOpen>>);

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
    check(method, frame, before, what, method.overlapping(frame));
  }
  /// The same, where it is told which boxes moved.
  static void check_told(M& method, const Frame<T>& frame, std::span<const std::uint32_t> moved,
                         std::vector<Pair>& before, const std::string& what) {
    if constexpr (TakesMoved<M>)
      check(method, frame, before, what + ", told", method.update(frame, moved));
  }
  static void check(M& method, const Frame<T>& frame, std::vector<Pair>& before,
                    const std::string& what, std::span<const Pair> found) {
    const auto right = pairs_by_definition<Contact>(frame);
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

/// Motions made to break what is kept from frame to frame, each for some frames, on one set; and
/// told which boxes moved.
TYPED_TEST_P(BoxMethod, HostileMotions) {
  using T = typename TypeParam::Scalar;
  for (const T largest : {T(0.06), T(0.3)}) {
    BoxMaker<T> random(13);
    const Frame<T> start = random.boxes(700, 0, 1, T(0.01), largest);
    Frame<T> boxes = start;
    TypeParam method(this->settings(Coherence::on)), told(this->settings(Coherence::on));
    std::vector<Pair> before, told_before;
    const auto move = [&](std::size_t k, T by, int axis) {
      boxes[k].lo[axis] += by, boxes[k].hi[axis] += by;
    };
    for (int frame = 0; frame < 160; ++frame) {
      const int motion = frame / 20, step = frame % 20;
      const Frame<T> last = boxes;
      switch (motion) {
        case 0:  // one through all others, and back
          boxes[3] = {{T(step) / 20, 0, 0}, {T(step) / 20 + T(0.2), 1, 1}};
          break;
        case 1:  // some to one point and out again
          for (std::size_t k = 0; k < 60; ++k)
            for (int axis = 0; axis < 3; ++axis) {
              const T way = (T(0.5) - start[k].lo[axis]) * T(step < 10 ? step + 1 : 20 - step) / 10;
              move(k, start[k].lo[axis] + way - boxes[k].lo[axis], axis);
            }
          break;
        case 2:  // growing beyond the scene, and shrinking to points
          for (std::size_t k = step % 2; k < 700; k += 31)
            for (int axis = 0; axis < 3; ++axis) {
              const T middle = (boxes[k].lo[axis] + boxes[k].hi[axis]) / 2,
                      half = step < 10 ? (boxes[k].hi[axis] - middle) * T(1.5) : T(0);
              boxes[k].lo[axis] = middle - half, boxes[k].hi[axis] = middle + half;
            }
          break;
        case 3:  // teleports of a half, then of a few
          for (std::size_t k = 0; k < 700; k += step < 5 ? 2 : 97)
            boxes[k] = random.box(0, 1, T(0.01), largest);
          break;
        case 4:  // a part drifts; the others come and go, more and less than leaves have room for
          for (std::size_t k = 0; k < boxes.size(); k += 40) move(k, T(0.003), step % 3);
          if (step % 3 == 0) boxes.resize(boxes.size() - 1 - random.below(9));
          if (step % 3 == 1)
            for (unsigned k = random.below(30); k > 0; --k)
              boxes.push_back(random.box(0, 1, T(0.01), largest));
          break;
        case 5:  // few and all in turn
          for (std::size_t k = 0; k < boxes.size(); k += step % 4 == 0 ? 1 : 50)
            move(k, T(step % 2 ? 0.002 : -0.002), step % 3);
          break;
        case 6:  // two take each other's places, together with their neighbours in the frame
          for (std::size_t k = 0; k < 6; ++k)
            std::swap(boxes[10 * k + static_cast<std::size_t>(step)], boxes[300 + 11 * k]);
          break;
        default:  // out of the scene, one by one, and all to one place
          for (std::size_t k = 30 * static_cast<std::size_t>(step);
               k < std::min(boxes.size(), 30 * static_cast<std::size_t>(step) + 30); ++k)
            boxes[k] = step % 2 ? random.box(50, 51, 0, 1) : Box<T>{{5, 5, 5}, {6, 6, 6}};
      }
      std::vector<std::uint32_t> moved{0, 0};  // twice, and though it did not move
      for (std::size_t k = 0; k < std::min(boxes.size(), last.size()); ++k)
        if (!(boxes[k] == last[k])) moved.push_back(static_cast<std::uint32_t>(k));
      const std::string what = "motion " + std::to_string(motion) + ", " + std::to_string(step);
      this->check(method, boxes, before, what);
      if (frame % 50 == 49 && TakesMoved<TypeParam>)
        this->check(told, boxes, told_before, what);
      else
        this->check_told(told, boxes, moved, told_before, what);
      if (this->HasFatalFailure()) return;
    }
  }
}

REGISTER_TYPED_TEST_SUITE_P(BoxMethod, EveryCaseFromScratch, OneMethodThroughEveryCase,
                            MovedForManyFrames, BoxesComeAndGo, FiveThousandBoxes, HostileMotions);

using Types = AsTypes<Methods<BVLAB_TEST_SCALAR, BVLAB_TEST_CONTACT>>::type;
INSTANTIATE_TYPED_TEST_SUITE_P(List, BoxMethod, Types);

}  // namespace
}  // namespace bvlab
