// SPDX-License-Identifier: BSD-3-Clause
/// K-DOPs that are posed by their vertices keep all laws, and their bounds are the best there are.
#include "hierarchies/volumes/kdop_corners.hpp"

#include "tests/laws/volume_laws.hpp"

namespace bvlab {
namespace {

using All = TypesInBothPrecisions<TypeList<Kdop<float, 6, ByCorners>, Kdop<float, 14, ByCorners>,
                                           Kdop<float, 18, ByCorners>, Kdop<float, 26, ByCorners>>>;
INSTANTIATE_TYPED_TEST_SUITE_P(KdopCorners, VolumeLaws, All);

template <class V>
constexpr int faces = static_cast<int>(std::tuple_size_v<decltype(V::bounds)>);

/// What may be paid for rounding, in units of roundoff: most of it is in double, for vertices.
constexpr double rounding = 500;

/// The largest n.x over the polytope, for each column n: over all points where three planes meet
/// that are inside. Written apart from what is tested: solved by Cramer's rule in long double.
template <int K>
std::vector<long double> supports(const std::array<double, K>& bounds,
                                  const std::vector<Vec3<long double>>& along) {
  using Directions = detail::KdopDirections<K>;
  std::vector<Vec3<long double>> normals;
  long double scale = 0;
  for (int m = 0; m < K; ++m) {
    normals.emplace_back(Directions::component(m, 0), Directions::component(m, 1),
                         Directions::component(m, 2));
    scale = std::max<long double>(scale, std::abs(bounds[m]));
  }
  std::vector<long double> most(along.size(), -std::numeric_limits<long double>::infinity());
  for (int i = 0; i < K; ++i)
    for (int j = i + 1; j < K; ++j)
      for (int k = j + 1; k < K; ++k) {
        const long double determinant = normals[i].cross(normals[j]).dot(normals[k]);
        if (determinant == 0) continue;
        const Vec3<long double> x =
            (bounds[i] * normals[j].cross(normals[k]) + bounds[j] * normals[k].cross(normals[i]) +
             bounds[k] * normals[i].cross(normals[j])) /
            determinant;
        bool inside = true;
        for (int m = 0; m < K && inside; ++m)
          inside = normals[m].dot(x) <= bounds[m] + 1e-17L * scale;
        if (!inside) continue;
        for (std::size_t n = 0; n < along.size(); ++n) most[n] = std::max(most[n], along[n].dot(x));
      }
  return most;
}

/// Any attitude, and a place at a distance; not drifted, which costs more than what is asked here.
Pose sound_pose(Hostile& hostile, double distance) {
  while (true) {
    const Pose pose = hostile.pose_of(hostile.direction() * distance);
    const Mat3<double> defect =
        pose.rotation.transpose() * pose.rotation - Mat3<double>::Identity();
    if (defect.norm() < 32 * unit_roundoff<double>) return pose;
  }
}

template <class V>
class KdopCorners : public ::testing::Test {};
TYPED_TEST_SUITE(KdopCorners, All);

TYPED_TEST(KdopCorners, BoundsAreTheSupportsOfThePolytope) {
  constexpr int K = faces<TypeParam>;
  using S = typename TypeParam::scalar;
  constexpr double e = unit_roundoff<S>;
  Hostile hostile(11);
  for (int round = 0; round < 500; ++round) {
    const Points points = hostile.cloud();
    const auto volume = TypeParam::enclosing(points);
    const double scale = reach(volume);
    if (!(scale < 1e15)) continue;  // squares overflow in float: nothing is bounded there
    const Pose pose = sound_pose(hostile, scale);
    const auto bounded = posed(volume, PlacementOf<TypeParam>(pose, pose.translation, scale));
    std::array<double, K> bounds;
    std::copy(volume.bounds.begin(), volume.bounds.end(), bounds.begin());
    std::vector<Vec3<long double>> along;
    for (int m = 0; m < K; ++m)
      along.push_back(
          (pose.rotation.transpose() * Vec3<double>(detail::KdopDirections<K>::component(m, 0),
                                                    detail::KdopDirections<K>::component(m, 1),
                                                    detail::KdopDirections<K>::component(m, 2)))
              .template cast<long double>());
    const auto most = supports<K>(bounds, along);
    // Beside what is relative Placement pays for underflow.
    const long double room = rounding * e * scale + 1e-15L;
    for (int m = 0; m < K; ++m) {
      ASSERT_GE(bounded.bounds[m], most[m]) << "round " << round << ", direction " << m;
      ASSERT_LE(bounded.bounds[m], most[m] + room) << "round " << round << ", direction " << m;
    }
  }
}

TYPED_TEST(KdopCorners, AreNeverLooserThanRealigned) {
  constexpr int K = faces<TypeParam>;
  using S = typename TypeParam::scalar;
  Hostile hostile(12);
  double saved = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto volume = TypeParam::enclosing(hostile.cloud());
    const Kdop<S, K> plain{volume.bounds};
    const double scale = reach(volume);
    if (!(scale < 1e15)) continue;  // squares overflow in float: nothing is bounded there
    const Pose pose = sound_pose(hostile, scale);
    const auto best = posed(volume, PlacementOf<TypeParam>(pose, pose.translation, scale));
    const auto realigned = posed(plain, PlacementOf<Kdop<S, K>>(pose, pose.translation, scale));
    for (int m = 0; m < K; ++m)
      ASSERT_LE(best.bounds[m], realigned.bounds[m] + rounding * unit_roundoff<S> * scale)
          << "round " << round << ", direction " << m;
    saved += size(best) < size(realigned) * 0.99;
  }
  // A box that is turned has no better bounds than those.
  if (K == 6)
    EXPECT_EQ(saved, 0);
  else
    EXPECT_GT(saved, 200);
}

TYPED_TEST(KdopCorners, FitTheirRoomAndBoxesAreTheException) {
  constexpr int K = faces<TypeParam>;
  Hostile hostile(13);
  int outside = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto volume = TypeParam::enclosing(hostile.cloud());
    ASSERT_GE(volume.count, 1);
    ASSERT_LE(volume.count, TypeParam::room);
    bool box = false;
    for (int i = 0; i < volume.count; ++i)
      for (int k = 0; k < K / 2; ++k) {
        const double at = detail::KdopDirections<K>::along(
            k, Vec3<double>(volume.corners[i][0], volume.corners[i][1], volume.corners[i][2]));
        const double room = 4 * volume.grain;
        box = box || at > volume.bounds[2 * k] + room || -at > volume.bounds[2 * k + 1] + room;
      }
    outside += box;
  }
  EXPECT_LT(outside, 2);
  const auto point = TypeParam::enclosing(std::array{Vec3<double>(0.1, 0.2, 0.3)});
  EXPECT_EQ(point.count, 1);
}

}  // namespace
}  // namespace bvlab
