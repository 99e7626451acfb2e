// SPDX-License-Identifier: BSD-3-Clause
#include "traversal/primitives/triangle_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/scenes/triangle_sets.hpp"
#include "traversal/primitives/gathered_corners.hpp"
#include "traversal/primitives/triangle_distance_bound.hpp"

namespace bvlab {
namespace {

std::string shown(const TrianglePair& pair) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (const auto& t : pair)
    for (const auto& p : t) text << "{" << p[0] << ", " << p[1] << ", " << p[2] << "} ";
  return text.str();
}

double extent(const TrianglePair& pair) {
  double largest = 0;
  for (const auto& p : pair)
    for (const auto& q : pair)
      for (const auto& x : p)
        for (const auto& y : q)
          for (int i = 0; i < 3; ++i)
            largest = std::max(largest, std::abs(x[i] / 2 - y[i] / 2) * 2);
  return largest;
}

/// How far a point may stand from where it should: the coordinates' own rounding.
double grain(const TrianglePair& pair) {
  double largest = 0;
  for (const auto& t : pair)
    for (const auto& p : t) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return 16 * unit_roundoff<double> * largest + std::numeric_limits<double>::denorm_min();
}

int meeting = 0, apart = 0, bounded = 0;

/// The bound is never above the truth, the same for one pair and for many; `bounded` counts where
/// it is hardly below it.
void expect_bounded(const TrianglePair& pair, long double truth) {
  using S = Batch<double, native_width<double>>;
  const Triangle *a[native_width<double>], *b[native_width<double>];
  std::fill(std::begin(a), std::end(a), &pair[0]);
  std::fill(std::begin(b), std::end(b), &pair[1]);
  const double bound = distance_bound<S>(detail::gathered<S>(a), detail::gathered<S>(b))[0];
  ASSERT_EQ(bound, distance_bound<double>(detail::corners_of(pair[0]), detail::corners_of(pair[1])))
      << shown(pair);
  ASSERT_GE(bound, 0) << shown(pair);
  ASSERT_LE(bound, truth) << shown(pair);
  bounded += truth > 0 && bound > 0.99L * truth;
}

/// Points computed in double-double are off by their coordinates' rounding alone.
void expect_points_rounded_once(const TrianglePair& pair, double distance, long double truth) {
  const auto& [a, b] = pair;
  const TriangleDistance found = bvlab::distance<DoubleDouble>(a, b);
  ASSERT_EQ(found.distance, distance) << shown(pair);
  const Triangle at_a = {found.on_a, found.on_a, found.on_a},
                 at_b = {found.on_b, found.on_b, found.on_b};
  // 2^-51 of the largest coordinate; of a subnormal one, half of the smallest number.
  const long double rounding = grain(pair) / 4 + std::numeric_limits<double>::denorm_min();
  ASSERT_LE(oracle::distance(at_a, a), rounding) << shown(pair);
  ASSERT_LE(oracle::distance(at_b, b), rounding) << shown(pair);
  ASSERT_LE(std::abs(oracle::distance(at_a, at_b) - truth), 2 * rounding + 1e-14L * truth)
      << shown(pair);
  if (truth == 0) {
    ASSERT_EQ(found.on_a, found.on_b) << shown(pair);
  }
}

void expect_right(const TrianglePair& pair) {
  const auto& [a, b] = pair;
  const long double truth = oracle::distance(a, b);
  const TriangleDistance found = distance(a, b);
  expect_bounded(pair, truth);
  ASSERT_EQ(found.distance == 0, truth == 0) << shown(pair);
  ++(truth == 0 ? meeting : apart);
  // The bound that the header states.
  const long double allowed = 1e-14L * truth +
                              std::ldexp(static_cast<long double>(extent(pair)), -90) +
                              std::numeric_limits<double>::denorm_min();
  ASSERT_LE(std::abs(found.distance - truth), allowed)
      << shown(pair) << "off by " << (found.distance - truth) / truth << " of " << truth;
  ASSERT_LE(std::abs(found.distance - distance(b, a).distance), 2 * allowed) << shown(pair);
  // The nearest points are where they are said to be.
  const Triangle at_a = {found.on_a, found.on_a, found.on_a},
                 at_b = {found.on_b, found.on_b, found.on_b};
  ASSERT_LE(oracle::distance(at_a, a), grain(pair)) << shown(pair);
  ASSERT_LE(oracle::distance(at_b, b), grain(pair)) << shown(pair);
  ASSERT_LE(std::abs(oracle::distance(at_a, at_b) - truth), 2 * grain(pair)) << shown(pair);
  expect_points_rounded_once(pair, found.distance, truth);
}

template <class F>
void expect_right_on(int pairs, const F& make) {
  meeting = apart = bounded = 0;
  for (int i = 0; i < pairs && !testing::Test::HasFatalFailure(); ++i) expect_right(make());
  EXPECT_GT(apart, pairs / 100);
}

class DistanceSets : public testing::TestWithParam<TriangleSet> {};

TEST_P(DistanceSets, AgreeWithRationalNumbers) {
  TriangleSource source(11);
  expect_right_on(800, [&] { return GetParam().next(source); });
  EXPECT_GT(meeting, 0);
  if (GetParam().name == "random") {
    EXPECT_EQ(bounded, apart);
  }
}

/// The same with the second moved away, little or far.
TEST_P(DistanceSets, AgreeAtAnyDistance) {
  TriangleSource source(12);
  expect_right_on(800, [&] {
    TrianglePair pair = GetParam().next(source);
    const Vec3<double> by = std::ldexp(1, source.integer(-40, 10)) * source.point();
    for (auto& p : pair[1]) p += by;
    return pair;
  });
}

INSTANTIATE_TEST_SUITE_P(TriangleDistance, DistanceSets, testing::ValuesIn(triangle_sets),
                         [](const auto& info) {
                           std::string name(info.param.name);
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return !std::isalnum(c); },
                               '_');
                           return name;
                         });

/// Edges parallel but for the last digits.
TEST(TriangleDistance, NearlyParallelEdges) {
  TriangleSource source(13);
  expect_right_on(1500, [&] {
    TrianglePair pair = source.random();
    const Vec3<double> by = std::ldexp(1, source.integer(-30, 2)) * source.point();
    for (int i = 0; i < 2; ++i) {
      pair[1][i] = pair[0][i] + by;
      if (source.integer(0, 1))
        pair[1][i] += std::ldexp(1, -source.integer(20, 52)) * source.point();
    }
    return pair;
  });
}

TEST(TriangleDistance, EveryScale) {
  TriangleSource source(14);
  for (const int exponent : {-1070, -1000, -600, -300, -110, 110, 300, 600, 1000, 1022})
    for (const bool touching : {false, true})
      expect_right_on(100, [&] {
        const TrianglePair pair = touching ? source.touching() : source.random();
        return TriangleSource::mapped(pair, [&](const auto& p) -> Vec3<double> {
          return p.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
        });
      });
}

/// The foot of the perpendicular lies next to an end of an edge, by less than rounding can tell
/// along so long an edge, whichever end that is.
TEST(TriangleDistance, FeetNextToTheEndsOfLongEdges) {
  constexpr double u = unit_roundoff<double>;
  TriangleSource source(18);
  const auto expect_right_at = [&](double length, double foot) {
    const Triangle upright = {Vec3<double>(-foot, 1, 0), Vec3<double>(-foot, 3, 1),
                              Vec3<double>(-foot, 3, -1)};
    const Triangle lying = {Vec3<double>(-length, 0, 0), Vec3<double>(0, 0, 0),
                            Vec3<double>(-length, -length, 0)};
    for (int turn = 0; turn < 3; ++turn)
      for (const bool reversed : {false, true}) {
        Triangle turned = {lying[turn], lying[(turn + 1) % 3], lying[(turn + 2) % 3]};
        if (reversed) std::swap(turned[0], turned[1]);
        expect_right({upright, turned});
        expect_right({turned, upright});
      }
  };
  expect_right_at(1e11, 5e-6);
  for (int digits = 0; digits <= 17; ++digits)
    for (int round = 0; round < 20 && !testing::Test::HasFatalFailure(); ++round) {
      const double length = std::pow(10, digits) * (1 + source.uniform() / 2);
      expect_right_at(length, source.uniform() * u * length * source.integer(0, 3));
    }
}

/// The same in any direction, and at any distance from the edge.
TEST(TriangleDistance, CornersNextToTheEndsOfLongEdges) {
  constexpr double u = unit_roundoff<double>;
  TriangleSource source(19);
  expect_right_on(4000, [&] {
    const double length = std::ldexp(1 + source.uniform() / 2, source.integer(0, 57));
    const Vec3<double> far = length * source.point();
    const Vec3<double> across = far.cross(source.point()).normalized();
    const double height = std::ldexp(1 + source.uniform() / 2, source.integer(-60, 2));
    const Vec3<double> corner =
        height * across + (source.integer(0, 8) * u * source.uniform() * length) * far.normalized();
    const Vec3<double> beyond =
        far + source.point() - (length * std::abs(source.uniform())) * across;
    TrianglePair pair = {
        Triangle{corner, corner + across + 0.3 * source.point(), corner + across + source.point()},
        Triangle{far, Vec3<double>::Zero(), beyond}};
    if (source.integer(0, 1)) std::swap(pair[1][0], pair[1][1]);
    return pair;
  });
}

/// Corners near each other, or far away by up to 10^17 times as much: in any direction, along an
/// edge, or beside the other's.
TEST(TriangleDistance, TrianglesFarLargerThanTheirDistance) {
  TriangleSource source(15);
  const auto direction = [&]() -> Vec3<double> {
    if (source.integer(0, 1)) return source.point();
    return Vec3<double>(source.integer(-1, 1), source.integer(-1, 1), source.integer(-1, 1));
  };
  for (const int most : {10, 20, 30, 40, 50, 57})
    expect_right_on(700, [&] {
      TrianglePair pair = source.random();
      const Vec3<double> by = source.point() + direction();
      for (auto& p : pair[1]) p += by;
      const Vec3<double> common = direction();
      for (auto& t : pair) {
        if (source.integer(0, 3) == 0) continue;
        const Vec3<double> along = source.integer(0, 1) ? common : direction();
        for (int far = source.integer(0, 1); far >= 0; --far) {
          const int i = source.integer(0, 2);
          const double factor = std::ldexp(1 + source.uniform() / 2, source.integer(0, most));
          t[i] += factor * (source.integer(0, 2) ? along : -along);
        }
      }
      return pair;
    });
}

/// Numbers from all over the range of doubles within one pair.
TEST(TriangleDistance, AnyMagnitudes) {
  TriangleSource source(16);
  expect_right_on(300, [&] { return source.any_magnitude(); });
  for (const int most : {-1000, -700, -300, -50, 0, 50, 99})
    expect_right_on(100, [&] { return source.any_magnitude(-1074, most); });
  for (const int least : {-300, -100, -99, -40, 0})
    expect_right_on(100, [&] { return source.any_magnitude(least, 99); });
}

/// Coordinates of usual magnitude in one plane, and next to each other in it: what matters is how
/// far they differ, not how large they are.
TEST(TriangleDistance, SmallDifferencesOfUsualCoordinates) {
  TriangleSource source(17);
  for (const int exponent : {-60, -99, -110, -250, -340, -540, -1000, -1060, 300})
    expect_right_on(100, [&] {
      TrianglePair pair = source.random();
      const Vec3<double> by = 3 * source.point();
      for (auto& p : pair[1]) p += by;
      const double level = source.integer(0, 1) ? 1 : source.uniform();
      return TriangleSource::mapped(pair, [&](const auto& p) {
        return Vec3<double>(level, std::ldexp(p[1], exponent), std::ldexp(p[2], exponent));
      });
    });
}

/// Triangles so small that the squares of their areas underflow, but for a corner or two.
TEST(TriangleDistance, SmallBesideOneCorner) {
  TriangleSource source(20);
  expect_right_on(2000, [&] {
    TrianglePair pair = source.random();
    const Vec3<double> by = 2 * source.point();
    for (auto& p : pair[1]) p += by;
    const int exponent = -source.integer(200, 560);
    pair = TriangleSource::mapped(pair, [&](const auto& p) -> Vec3<double> {
      return p.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
    });
    for (auto& t : pair)
      if (source.integer(0, 1)) t[source.integer(0, 2)] = source.grid_point();
    return pair;
  });
}

}  // namespace
}  // namespace bvlab
