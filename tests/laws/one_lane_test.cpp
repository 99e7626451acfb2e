// SPDX-License-Identifier: BSD-3-Clause
/// Batches without registers, batches on the compiler's own vectors and std::experimental::simd
/// answer alike, lane by lane, NaN and signed zeros among the numbers. The last is left out under
/// clang, where it is wrong (see vector_lanes.hpp).
#include "hierarchies/geometry/one_lane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "hierarchies/geometry/vector_lanes.hpp"
#if !defined(__clang__)
#include <experimental/simd>
#endif

namespace bvlab {
namespace {

template <class Batch>
void fill(Batch& batch, std::mt19937& random) {
  using T = typename Batch::value_type;
  constexpr T nan = std::numeric_limits<T>::quiet_NaN(), far = std::numeric_limits<T>::infinity();
  const T some[] = {0, -T(0), 1, -1, 3, T(0.1), far, -far, nan, std::numeric_limits<T>::max()};
  for (std::size_t i = 0; i < Batch::size(); ++i) batch[i] = some[random() % 10];
}

template <class A, class B>
void expect_same(const A& theirs, const B& ours, const char* what) {
  for (std::size_t i = 0; i < A::size(); ++i) {
    const auto a = theirs[i];
    const auto b = ours[i];
    const bool both_nan = std::isnan(a) && std::isnan(b);
    EXPECT_TRUE(both_nan || (a == b && std::signbit(a) == std::signbit(b)))
        << what << ", lane " << i << ": " << a << ", " << b;
  }
}

template <class A, class B>
void expect_same_lanes(const A& theirs, const B& ours, const char* what) {
  for (std::size_t i = 0; i < A::size(); ++i)
    EXPECT_EQ(static_cast<bool>(theirs[i]), static_cast<bool>(ours[i])) << what << ", lane " << i;
}

/// NaN and signed zeros replaced: what min and max give of these is left open.
template <class Batch>
Batch plain(Batch batch) {
  for (std::size_t i = 0; i < Batch::size(); ++i) {
    const typename Batch::value_type x = batch[i];
    batch[i] = std::isnan(x) ? 2 : x == 0 ? 0 : x;
  }
  return batch;
}

template <class Theirs, class Ours>
void compare() {
  using T = typename Theirs::value_type;
  static_assert(Theirs::size() == Ours::size());
  std::mt19937 random(5), again(5);
  for (int round = 0; round < 300; ++round) {
    Theirs a, b;
    Ours c, d;
    fill(a, random), fill(b, random), fill(c, again), fill(d, again);
    expect_same(a, c, "as written");
    expect_same(a + b, c + d, "+");
    expect_same(a - b, c - d, "-");
    expect_same(a * b, c * d, "*");
    expect_same(a / b, c / d, "/");
    expect_same(-a, -c, "negated");
    expect_same(abs(a), abs(c), "abs");
    expect_same(sqrt(a), sqrt(c), "sqrt");
    expect_same(min(plain(a), plain(b)), min(plain(c), plain(d)), "min");
    expect_same(max(plain(a), plain(b)), max(plain(c), plain(d)), "max");
    expect_same(Theirs(-T(0)), Ours(-T(0)), "one number");
    const auto less = a < b;
    const auto ours = c < d;
    expect_same_lanes(less, ours, "<");
    expect_same_lanes(a <= b, c <= d, "<=");
    expect_same_lanes(a > b, c > d, ">");
    expect_same_lanes(a >= b, c >= d, ">=");
    expect_same_lanes(!(a == b), !(c == d), "==");
    expect_same_lanes(less || a != b, ours || c != d, "||");
    expect_same_lanes(less && a != b, ours && c != d, "&&");
    EXPECT_EQ(all_of(less), all_of(ours));
    EXPECT_EQ(any_of(less), any_of(ours));
    where(less, a) = b;
    where(ours, c) = d;
    expect_same(a, c, "where");
  }
}

template <class T, int W>
using OneLane = one_lane::simd<T, one_lane::simd_abi::deduce_t<T, W>>;
template <class T, int W>
using VectorLanes = vector_lanes::simd<T, vector_lanes::simd_abi::deduce_t<T, W>>;

TEST(Lanes, OneByOneAndVectorsAreAlike) {
  compare<VectorLanes<float, 1>, OneLane<float, 1>>();
  compare<VectorLanes<float, 4>, OneLane<float, 4>>();
  compare<VectorLanes<double, 2>, OneLane<double, 2>>();
  compare<VectorLanes<double, 4>, OneLane<double, 4>>();
  compare<VectorLanes<float, 8>, OneLane<float, 8>>();
  compare<VectorLanes<float, 16>, OneLane<float, 16>>();
}

TEST(Lanes, BitsAreLanes) {
  std::mt19937 random(7);
  const auto look = [&]<class Batch>(Batch x) {
    for (int round = 0; round < 100; ++round) {
      fill(x, random);
      const auto mask = x > Batch(0);
      std::uint64_t bits = 0;
      for (std::size_t i = 0; i < Batch::size(); ++i) bits |= std::uint64_t{mask[i]} << i;
      EXPECT_EQ(mask.bits(), bits);
    }
  };
  look(VectorLanes<double, 2>()), look(VectorLanes<float, 4>()), look(VectorLanes<float, 8>());
  look(VectorLanes<double, 8>()), look(VectorLanes<float, 16>()), look(OneLane<float, 16>());
}

#if !defined(__clang__)
namespace stdx = std::experimental;
template <class T, int W>
using Registers = stdx::simd<T, stdx::simd_abi::deduce_t<T, W>>;

TEST(Lanes, VectorsAreWhatTheStandardLibraryHas) {
  compare<Registers<float, 1>, VectorLanes<float, 1>>();
  compare<Registers<float, 4>, VectorLanes<float, 4>>();
  compare<Registers<double, 2>, VectorLanes<double, 2>>();
  compare<Registers<float, 8>, VectorLanes<float, 8>>();
  compare<Registers<float, 16>, VectorLanes<float, 16>>();
}
#endif

TEST(Lanes, LeastAndMost) {
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
