// SPDX-License-Identifier: BSD-3-Clause
/// Batches without registers answer as those with registers do, lane by lane, numbers that are none
/// among them.
#include "hierarchies/geometry/one_lane.hpp"

#include <gtest/gtest.h>

#include <experimental/simd>
#include <limits>
#include <random>

namespace bvlab {
namespace {

namespace stdx = std::experimental;

template <class T, int W>
class Pairs {
 public:
  using Theirs = stdx::simd<T, stdx::simd_abi::deduce_t<T, W>>;
  using Ours = one_lane::simd<T, one_lane::simd_abi::deduce_t<T, W>>;

  /// Fills both with the same numbers.
  void draw(std::mt19937& random) {
    constexpr T nan = std::numeric_limits<T>::quiet_NaN(), far = std::numeric_limits<T>::infinity();
    const T some[] = {0, -T(0), 1, -1, 3, T(0.1), far, -far, nan, std::numeric_limits<T>::max()};
    T values[W];
    for (T& value : values) value = some[random() % 10];
    theirs.copy_from(values, stdx::element_aligned);
    ours.copy_from(values, one_lane::element_aligned);
  }

  Theirs theirs;
  Ours ours;
};

template <class A, class B>
void expect_same(const A& theirs, const B& ours, const char* what) {
  for (std::size_t i = 0; i < A::size(); ++i) {
    const auto a = theirs[i];
    const auto b = ours[i];
    EXPECT_TRUE(a == b || (a != a && b != b)) << what << ", lane " << i << ": " << a << ", " << b;
  }
}

template <class T, int W>
void compare() {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    Pairs<T, W> a, b;
    a.draw(random), b.draw(random);
    expect_same(a.theirs + b.theirs, a.ours + b.ours, "+");
    expect_same(a.theirs - b.theirs, a.ours - b.ours, "-");
    expect_same(a.theirs * b.theirs, a.ours * b.ours, "*");
    expect_same(a.theirs / b.theirs, a.ours / b.ours, "/");
    expect_same(-a.theirs, -a.ours, "negated");
    expect_same(stdx::abs(a.theirs), one_lane::abs(a.ours), "abs");
    expect_same(stdx::sqrt(a.theirs), one_lane::sqrt(a.ours), "sqrt");
    const auto less = a.theirs < b.theirs;
    const auto ours = a.ours < b.ours;
    EXPECT_EQ(less.__to_bitset().to_ullong(), ours.__to_bitset().to_ullong());
    EXPECT_EQ((a.theirs >= b.theirs).__to_bitset().to_ullong(),
              (a.ours >= b.ours).__to_bitset().to_ullong());
    EXPECT_EQ((!(a.theirs == b.theirs) ^ less).__to_bitset().to_ullong(),
              (!(a.ours == b.ours) ^ ours).__to_bitset().to_ullong());
    EXPECT_EQ(stdx::all_of(less), one_lane::all_of(ours));
    EXPECT_EQ(stdx::any_of(less), one_lane::any_of(ours));
    stdx::where(less, a.theirs) = b.theirs;
    one_lane::where(ours, a.ours) = b.ours;
    expect_same(a.theirs, a.ours, "where");
  }
}

TEST(OneLane, IsWhatRegistersAre) {
  compare<float, 1>();
  compare<float, 4>();
  compare<double, 2>();
  compare<float, 16>();
}

TEST(OneLane, LeastAndMost) {
  const one_lane::simd<float, one_lane::simd_abi::lanes<4>> x(
      [](auto i) { return static_cast<float>((i() * 7 + 3) % 5); });  // 3 0 2 4
  EXPECT_EQ(one_lane::hmin(x), 0);
  EXPECT_EQ(one_lane::hmax(x), 4);
  const auto least = one_lane::min(x, decltype(x)(2)), most = one_lane::max(x, decltype(x)(2));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(least[i], std::min(x[i], 2.0f));
    EXPECT_EQ(most[i], std::max(x[i], 2.0f));
  }
}

}  // namespace
}  // namespace bvlab
