// SPDX-License-Identifier: BSD-3-Clause
#include "traversal/primitives/triangle_intersection.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/oracles/triangle_oracle.hpp"

namespace bvlab {
namespace {

using Pair = std::array<Triangle, 2>;
using Random = std::mt19937_64;

std::string shown(const Pair& pair) {
  std::ostringstream text;
  text << std::hexfloat;
  for (const auto& t : pair)
    for (const auto& p : t) text << "{" << p[0] << ", " << p[1] << ", " << p[2] << "} ";
  return text.str();
}

double uniform(Random& random) { return std::uniform_real_distribution<double>(-1, 1)(random); }

Vec3<double> random_point(Random& random) {
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

Mat3<double> random_rotation(Random& random) {
  Eigen::Quaterniond q(uniform(random), uniform(random), uniform(random), uniform(random));
  return q.normalized().toRotationMatrix();
}

Vec3<double> grid_point(Random& random, int cells) {
  std::uniform_int_distribution<int> cell(0, cells);
  const double x = cell(random), y = cell(random), z = cell(random);
  return {x, y, z};
}

template <class F>
Pair pair_of(const F& point) {
  Pair pair;
  for (auto& t : pair)
    for (auto& p : t) p = point();
  return pair;
}

template <class F>
Pair mapped(Pair pair, const F& f) {
  for (auto& t : pair)
    for (auto& p : t) p = f(p);
  return pair;
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
  std::apply([&](auto... precision) { (expect_one_by_one<decltype(precision)>(batch), ...); },
             Precisions{});
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

TEST(TriangleIntersection, Random) {
  Random random(1);
  expect_right_on(20000, [&] { return pair_of([&] { return random_point(random); }); });
}

TEST(TriangleIntersection, IntegerGrid) {
  Random random(2);
  for (const int cells : {1, 2, 3, 5})
    expect_right_on(10000, [&] { return pair_of([&] { return grid_point(random, cells); }); });
}

TEST(TriangleIntersection, IntegerGridThenRotated) {
  Random random(3);
  for (const int cells : {1, 2, 3, 5})
    expect_right_on(10000, [&] {
      const Mat3<double> rotation = random_rotation(random);
      return mapped(pair_of([&] { return grid_point(random, cells); }),
                    [&](const auto& p) { return Vec3<double>(rotation * p); });
    });
}

TEST(TriangleIntersection, Coplanar) {
  Random random(4);
  for (int dropped = 0; dropped < 3; ++dropped)
    expect_right_on(5000, [&] {
      return pair_of([&] {
        Vec3<double> p = random_point(random);
        p[dropped] = 0.25;
        return p;
      });
    });
}

TEST(TriangleIntersection, CoplanarThenRotated) {
  Random random(5);
  expect_right_on(10000, [&] {
    const Mat3<double> rotation = random_rotation(random);
    return mapped(pair_of([&] {
                    Vec3<double> p = random_point(random);
                    p[2] = 0;
                    return p;
                  }),
                  [&](const auto& p) { return Vec3<double>(rotation * p); });
  });
}

TEST(TriangleIntersection, EveryScaleFromTheLeastToTheLargest) {
  Random random(6);
  for (const int exponent :
       {-1074, -1060, -1000, -700, -350, -340, -233, -100, 100, 233, 340, 700, 1000, 1020})
    expect_right_on(500, [&] {
      return mapped(pair_of([&] { return grid_point(random, 3); }),
                    [&](const auto& p) { return Vec3<double>(p * std::ldexp(1, exponent)); });
    });
  for (const int exponent : {-1070, -1000, -340, -233, 233, 340, 1000, 1023})
    expect_right_on(500, [&] {
      return mapped(pair_of([&] { return random_point(random); }), [&](const auto& p) {
        return p.unaryExpr([&](double x) { return std::ldexp(x, exponent); }).eval();
      });
    });
}

TEST(TriangleIntersection, MixedMagnitudes) {
  Random random(7);
  for (const int spread : {10, 30, 60, 120, 300, 1000})
    expect_right_on(1000, [&] {
      return pair_of([&] {
        return random_point(random)
            .unaryExpr([&](double x) {
              return std::ldexp(x, std::uniform_int_distribution<int>(-spread, spread)(random));
            })
            .eval();
      });
    });
}

}  // namespace
}  // namespace bvlab
