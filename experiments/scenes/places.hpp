// SPDX-License-Identifier: BSD-3-Clause
/// The poses of bodies while a scene is made, and how that is written into a trace. Only operations
/// that are the same on every machine.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/random.hpp"
#include "hierarchies/geometry/pose.hpp"

namespace bvlab {

using Quaternion = std::array<double, 4>;  // w, x, y, z

inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {((a[0] * b[0] - a[1] * b[1]) - a[2] * b[2]) - a[3] * b[3],
          ((a[0] * b[1] + a[1] * b[0]) + a[2] * b[3]) - a[3] * b[2],
          ((a[0] * b[2] - a[1] * b[3]) + a[2] * b[0]) + a[3] * b[1],
          ((a[0] * b[3] + a[1] * b[2]) - a[2] * b[1]) + a[3] * b[0]};
}

inline Quaternion normalised(Quaternion q) {
  const double norm = std::sqrt(((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]) + q[3] * q[3]);
  for (double& component : q) component /= norm;
  return q;
}

struct Place {
  Vec3<double> centre = Vec3<double>::Zero();
  Quaternion attitude = {1, 0, 0, 0};
};

/// A trace's numbers for a body: x y z qw qx qy qz. The mesh's origin is where turning about
/// the centre leaves it.
inline std::array<double, 7> row_of(const Place& place, const Extent& mesh) {
  const auto& [centre, q] = place;
  const Vec3<double>& c = mesh.centre;
  const Quaternion turned = product(product(q, {0, c[0], c[1], c[2]}), {q[0], -q[1], -q[2], -q[3]});
  return {
      centre[0] - turned[1], centre[1] - turned[2], centre[2] - turned[3], q[0], q[1], q[2], q[3]};
}

/// Exactly what reading the trace gives.
inline Pose pose_of(const Place& place, const Extent& mesh) {
  const auto row = row_of(place, mesh);
  return *pose_from({row[0], row[1], row[2]}, row[3], row[4], row[5], row[6]);
}

inline void append(std::vector<double>& trace, const Place& place, const Extent& mesh) {
  const auto row = row_of(place, mesh);
  trace.insert(trace.end(), row.begin(), row.end());
}

/// Throws Unusable where what an option needs is not so.
inline void need(bool fulfilled, const std::string& what) {
  if (!fulfilled) throw Unusable(what);
}

/// The same where a trace would be too long.
inline void need_few_poses(std::size_t frames, std::size_t objects) {
  std::size_t entries = 0;
  need(!__builtin_mul_overflow(frames, objects, &entries) && entries <= (std::size_t{1} << 32),
       "frames, objects: more than 2^32 poses");
}

/// Anywhere in a cube about the origin, at any attitude.
inline Place anywhere(Random& random, double half_side) {
  Place place;
  for (int d = 0; d < 3; ++d) place.centre[d] = random.uniform(-half_side, half_side);
  place.attitude = random.rotation();
  return place;
}

}  // namespace bvlab
