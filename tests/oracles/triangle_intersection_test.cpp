// SPDX-License-Identifier: BSD-3-Clause
#include "traversal/primitives/triangle_intersection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <string>

#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/scenes/triangle_sets.hpp"
#include "traversal/primitives/triangle_margin.hpp"

namespace bvlab {
namespace {

using Pair = TrianglePair;

std::string shown(const Pair& pair) {
  std::ostringstream text;
  text << std::hexfloat;
  for (const auto& t : pair)
    for (const auto& p : t) text << "{" << p[0] << ", " << p[1] << ", " << p[2] << "} ";
  return text.str();
}

int meeting = 0, apart = 0;

/// Both arguments in either order and every order of corners give what the oracle says.
void expect_right(const Pair& pair) {
  const bool truth = oracle::intersect(pair[0], pair[1]);
  ++(truth ? meeting : apart);
  int order_a[] = {0, 1, 2};
  do {
    int order_b[] = {0, 1, 2};
    do {
      const Triangle a = {pair[0][order_a[0]], pair[0][order_a[1]], pair[0][order_a[2]]};
      const Triangle b = {pair[1][order_b[0]], pair[1][order_b[1]], pair[1][order_b[2]]};
      ASSERT_EQ(intersect(a, b), truth) << shown(pair);
      ASSERT_EQ(intersect(b, a), truth) << shown(pair);
      ASSERT_LE(truth, intersect<Float64>(a, b)) << shown(pair);
      ASSERT_LE(truth, intersect<Float32>(a, b)) << shown(pair);
    } while (std::next_permutation(order_b, order_b + 3));
  } while (std::next_permutation(order_a, order_a + 3));
}

template <class Precision>
void expect_one_by_one(const std::vector<Pair>& batch) {
  const Triangle *a[64], *b[64];
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    a[i] = &batch[i][0], b[i] = &batch[i][1];
    hits |= std::uint64_t{intersect<Precision>(*a[i], *b[i])} << i;
  }
  ASSERT_EQ(intersect_batch<Precision>(a, b, static_cast<int>(batch.size())), hits)
      << Precision::name;
}

/// A batch says of each pair what is said of it alone, at every precision.
void expect_right_at_once(std::vector<Pair>& batch) {
  Precisions::for_each(
      [&]<class Precision>(std::type_identity<Precision>) { expect_one_by_one<Precision>(batch); });
  batch.clear();
}

/// The set is worth its name only if it holds pairs of both kinds.
template <class F>
void expect_right_on(int pairs, const F& make) {
  meeting = apart = 0;
  std::vector<Pair> batch;
  for (int i = 0; i < pairs && !testing::Test::HasFatalFailure(); ++i) {
    batch.push_back(make());
    expect_right(batch.back());
    // Batches of 1 to 64, as they come.
    if (batch.size() == static_cast<std::size_t>(1 + i % 64)) expect_right_at_once(batch);
  }
  EXPECT_GT(meeting, pairs / 100);
  EXPECT_GT(apart, pairs / 100);
}

class TriangleSets : public testing::TestWithParam<TriangleSet> {};

TEST_P(TriangleSets, AgreeWithRationalNumbers) {
  TriangleSource source(1);
  expect_right_on(10000, [&] { return GetParam().next(source); });
}

INSTANTIATE_TEST_SUITE_P(TriangleIntersection, TriangleSets, testing::ValuesIn(triangle_sets),
                         [](const auto& info) {
                           std::string name(info.param.name);
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return !std::isalnum(c); },
                               '_');
                           return name;
                         });

TEST(TriangleIntersection, EveryScaleFromTheLeastToTheLargest) {
  TriangleSource source(6);
  const auto scaled = [](const Pair& pair, int exponent) {
    return TriangleSource::mapped(pair, [&](const auto& p) -> Vec3<double> {
      return p.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
    });
  };
  for (const int exponent :
       {-1074, -1060, -1000, -700, -350, -340, -233, -100, 100, 233, 340, 700, 1000, 1020})
    expect_right_on(200, [&] { return scaled(source.grid(), exponent); });
  for (const int exponent : {-1070, -1000, -340, -233, 233, 340, 1000, 1023}) {
    expect_right_on(200, [&] { return scaled(source.random(), exponent); });
    expect_right_on(200, [&] { return scaled(source.touching(), exponent); });
  }
}

TEST(TriangleIntersection, MixedMagnitudes) {
  TriangleSource source(7);
  for (const int spread : {10, 30, 60, 120, 300, 1000})
    expect_right_on(150, [&] {
      return TriangleSource::corners([&]() -> Vec3<double> {
        return source.point().unaryExpr(
            [&](double x) { return std::ldexp(x, source.integer(-spread, spread)); });
      });
    });
}

/// Zeros, the least numbers there are and nearly the largest, within one predicate.
TEST(Orientation, AnyMagnitudes) {
  TriangleSource source(12);
  int zeros = 0, others = 0;
  for (int round = 0; round < 20000; ++round) {
    const TrianglePair pair = source.any_magnitude(-1074, source.integer(-1000, 1020));
    const auto& [a, b, c] = pair[0];
    for (const auto& d : pair[1]) {
      const int truth = oracle::orientation(a, b, c, d);
      ++(truth == 0 ? zeros : others);
      ASSERT_EQ(orientation(a, b, c, d), truth) << shown(pair);
      ASSERT_EQ(orientation(b, a, c, d), -truth) << shown(pair);
      ASSERT_EQ(orientation(d, c, b, a), truth) << shown(pair);
    }
    for (int i = 0; i < 3; ++i)
      for (const auto& d : pair[1])
        ASSERT_EQ(orientation(a, b, d, i, (i + 1) % 3),
                  oracle::orientation(a, b, d, i, (i + 1) % 3))
            << shown(pair);
  }
  EXPECT_GT(zeros, 5000);
  EXPECT_GT(others, 5000);
}

/// Coordinates whose ratio is beyond 2^1133, so that the least vanish when the largest are scaled
/// to integers of 60 digits: the first pair is apart (x > y at all corners of the second), the
/// other one touches.
TEST(TriangleIntersection, NumbersThatVanishBesideOthers) {
  const Pair apart_by_the_least = {
      Triangle{Vec3<double>(0, 0, 0), Vec3<double>(1e20, 1e20, 0), Vec3<double>(0, 0, 1e20)},
      Triangle{Vec3<double>(5e-324, 0, 1e19), Vec3<double>(1e20, 0, 1e19),
               Vec3<double>(1e20, 0, 2e19)}};
  const Pair touching = {
      Triangle{Vec3<double>(-1e-323, -2e-323, 0), Vec3<double>(0, 0, 0),
               Vec3<double>(-5e-324, 7.378697629483821e19, 0)},
      Triangle{Vec3<double>(-1.5e-323, 1e-323, 0), Vec3<double>(5e-324, -1.8446744073709552e19, 0),
               Vec3<double>(2e-323, 0, 0)}};
  for (const auto& [pair, truth] : {std::pair(apart_by_the_least, false), {touching, true}}) {
    ASSERT_EQ(oracle::intersect(pair[0], pair[1]), truth);
    expect_right(pair);
    std::vector<Pair> batch(3, pair);
    expect_right_at_once(batch);
  }
}

TEST(TriangleIntersection, AnyMagnitudes) {
  TriangleSource source(13);
  expect_right_on(500, [&] { return source.any_magnitude(); });
  // Nothing out of the filters' reach, so that all of them have their say.
  for (const int most : {-1000, -700, -300, 0, 100, 300})
    expect_right_on(150, [&] { return source.any_magnitude(-1074, most); });
  for (const int least : {-300, -100, -40, 0})
    expect_right_on(150, [&] { return source.any_magnitude(least, 330); });
}

TEST(TriangleIntersection, FarFromTheOrigin) {
  TriangleSource source(8);
  for (const double offset : {1e2, 1e4, 1e8, 1e12, 1e16})
    expect_right_on(1000, [&] { return source.moved(source.touching(), offset); });
}

/// Grids that pass for zeros in the second stage (up to 2^29 steps a side), or just not.
TEST(TriangleIntersection, GridsOfManySteps) {
  TriangleSource source(9);
  for (const int digits : {4, 12, 15, 16, 24, 28, 29, 30, 31, 40, 50})
    for (const double offset : {0.0, 0x1p20, -0x1p45})
      expect_right_on(300, [&] {
        TrianglePair pair = TriangleSource::corners([&]() -> Vec3<double> {
          return source.point().unaryExpr(
              [&](double x) { return std::nearbyint(std::ldexp(x, digits)); });
        });
        // A corner in the other's plane, or all of them, by whole steps.
        const auto& [a, b, c] = pair[0];
        const int most = source.integer(0, 2);
        for (int i = 0; i <= most; ++i)
          pair[1][i] = a + source.integer(-1, 1) * (b - a) + source.integer(-1, 1) * (c - a);
        return TriangleSource::mapped(
            pair, [&](const auto& p) -> Vec3<double> { return (p.array() + offset).matrix(); });
      });
}

/// What the second stage is certain of is so, a register at a time and one by one; and it leaves
/// little open where it is meant to decide.
TEST(TriangleRefinement, IsRightWhereItIsCertain) {
  constexpr std::size_t width = native_width<double>;
  using S = Batch<double, width>;
  for (const TriangleSet& set : triangle_sets) {
    TriangleSource source(10);
    int open = 0;
    constexpr int rounds = 200;
    for (int round = 0; round < rounds; ++round) {
      TrianglePair pairs[width];
      Corners<S> a, b;
      for (std::size_t lane = 0; lane < width; ++lane) {
        pairs[lane] = set.next(source);
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k)
            a[i][k][lane] = pairs[lane][0][i][k], b[i][k][lane] = pairs[lane][1][i][k];
      }
      const auto verdict = certainly_refined<S>(a, b);
      for (std::size_t lane = 0; lane < width; ++lane) {
        const auto& [s, t] = pairs[lane];
        const bool truth = oracle::intersect(s, t);
        ASSERT_FALSE(verdict.apart[lane] && truth) << set.name << shown(pairs[lane]);
        ASSERT_FALSE(verdict.meeting[lane] && !truth) << set.name << shown(pairs[lane]);
        const auto alone = certainly_refined<double>(detail::corners_of(s), detail::corners_of(t));
        ASSERT_EQ(alone.apart, verdict.apart[lane]) << set.name << shown(pairs[lane]);
        ASSERT_EQ(alone.meeting, verdict.meeting[lane]) << set.name << shown(pairs[lane]);
        open += !verdict.apart[lane] && !verdict.meeting[lane];
      }
    }
    if (!set.name.starts_with("without area")) {
      EXPECT_LT(open, rounds * static_cast<int>(width) / 8) << set.name;
    }
  }
}

/// Every shortcut that says "certain", by itself, against rational numbers, over bands of the
/// range: where all is tiny, where all is in reach, and where some is not.
TEST(Shortcuts, AreRightWhereTheyAreCertain) {
  TriangleSource source(14);
  int certain[4] = {};
  const auto expect_true = [&](const TrianglePair& pair) {
    const auto& [a, b] = pair;
    const bool truth = oracle::intersect(a, b);
    const auto agrees = [&](const auto& verdict, int which) {
      certain[which] += verdict.apart || verdict.meeting;
      return !(verdict.apart && truth) && !(verdict.meeting && !truth);
    };
    const auto x = detail::corners_of(a), y = detail::corners_of(b);
    ASSERT_TRUE(agrees(certainly<double>(x, y), 0)) << shown(pair);
    // Where the boxes overlap.
    if (!filter::BoxAndBound<double, CornersAre::given>(x, y).apart) {
      ASSERT_TRUE(agrees(certainly_refined<double>(x, y), 1)) << shown(pair);
    }
    Corners<float> p, q;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        p[i][k] = static_cast<float>(a[i][k]), q[i][k] = static_cast<float>(b[i][k]);
    ASSERT_TRUE(agrees(certainly<float, CornersAre::rounded>(p, q), 2)) << shown(pair);
    const Triangle *of_a[] = {&a}, *of_b[] = {&b};
    double margin;
    const bool touching =
        touching_with_margins(of_a, of_b, 1, intersect_batch<Exact>, &margin) != 0;
    ASSERT_EQ(touching, truth) << shown(pair);
    certain[3] += margin > 0;
    if (!truth && margin > 0) {
      ASSERT_LE(margin, oracle::distance(a, b)) << shown(pair);
    }
  };
  const auto expect_true_on = [&](int pairs, const auto& make) {
    for (int i = 0; i < pairs && !testing::Test::HasFatalFailure(); ++i) expect_true(make());
  };
  for (const int least : {-1074, -1000, -540, -160, -80, -30, 0})
    for (const int most : {-1000, -500, -150, -70, -20, 0, 35, 41, 100, 330, 345, 512, 1020})
      if (least < most) expect_true_on(300, [&] { return source.any_magnitude(least, most); });
  for (const TriangleSet& set : triangle_sets)
    expect_true_on(300, [&] {
      const int exponent = source.integer(-1060, 1000);
      return TriangleSource::mapped(set.next(source), [&](const auto& p) -> Vec3<double> {
        return p.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
      });
    });
  for (const int count : certain) EXPECT_GT(count, 1000);
}

/// The way without a fused multiply-add is exact, too.
TEST(TriangleRefinement, WhatAProductLoses) {
  TriangleSource source(11);
  for (int round = 0; round < 10000; ++round) {
    const double a = std::ldexp(source.uniform(), source.integer(-300, 300));
    const double b = std::ldexp(source.uniform(), source.integer(-300, 300));
    ASSERT_EQ(filter::lost_in_product_by_parts<double>(a, b, a * b), std::fma(a, b, -(a * b)));
  }
}

}  // namespace
}  // namespace bvlab
