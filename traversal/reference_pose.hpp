// SPDX-License-Identifier: BSD-3-Clause
/// A reference pose, and bounds on how far a body has moved since.
///
/// A point of a body, given by v relative to the body's centre c in the mesh's frame, lies at
/// x = (Rc + t) + Rv. From a pose r to a pose f it moves by
///
///   (c_f - c_r) + (R_f - R_r) v,   |(R_f - R_r) v| <= |R_f - R_r|_2 radius.
///
/// The singular values of the difference of two rotations by an angle of s between them are
/// 2 sin(s / 2), 2 sin(s / 2) and 0, so that |R_f - R_r|_2 = |R_f - R_r|_F / sqrt(2): nothing needs
/// a quaternion or an angle. A matrix that is no rotation is within d = |R'R - I|_F of the nearest
/// orthonormal one (its singular values s give |s - 1| <= |s^2 - 1|), hence
///
///   |R_f - R_r|_2 <= (F + d_f + d_r) / sqrt(2) + d_f + d_r,   F = |R_f - R_r|_F,
///
/// where both have determinants of the same sign, which holds if F + d_f + d_r < 2; else F itself
/// is the bound. For one point on each of two bodies the difference of their displacements is at
/// most
///
///   |(c_f - c_r)_a - (c_f - c_r)_b| + |R_f - R_r|_2,a radius_a + |R_f - R_r|_2,b radius_b,
///
/// so that bodies carried along together do not approach.
///
/// Rounding. A posed vertex, fl(Rv + t), and a posed centre, fl(Rc + t), are each off by less than
/// 8u (reach + |t|) (see placement.hpp), where the mesh has an origin of its own by the error of
/// LocalPose, too. `error_bound` is twice the sum of both, and is counted at
/// both poses. The sums of squares and their roots are off by less than 16 roundings in relative
/// terms, those of the whole by 16 more: a factor of 1 + 32u covers all.
///
/// Range. A square that underflows hides a motion below 2^-511, in each of at most three terms.
/// Every bound on motion includes `error_bound` of both poses, 2^-48 (reach + |t|) each, which is
/// more for any mesh larger than 2^-460. An overflow makes the bound infinite or NaN, and every
/// comparison treats that as expired.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/local_pose.hpp"
#include "hierarchies/geometry/small_matrices.hpp"
#include "hierarchies/hierarchy_extent.hpp"

namespace bvlab {

/// A body's pose, with what is needed to bound its later motion.
struct ReferencePose {
  Mat3<double> rotation = Mat3<double>::Identity();
  Vec3<double> centre = Vec3<double>::Zero();  ///< of the body, in the world
  double defect = 0;                           ///< at least |R'R - I|_F
  double error_bound = 0;                      ///< of everything above, in units of the mesh

  ReferencePose() = default;
  ReferencePose(const Pose& pose, const HierarchyExtent& extent) : rotation(pose.rotation) {
    defect = defect_of(rotation) + 16 * unit_roundoff<double>;
    if (LocalMesh::has_own_origin(extent.origin)) [[unlikely]] {
      const LocalPose local(pose, extent.origin, extent.reach);
      put_centre(local.pose, extent), error_bound += 2 * local.error;
    } else {
      put_centre(pose, extent);
    }
  }

 private:
  void put_centre(const Pose& pose, const HierarchyExtent& extent) {
    centre = pose(extent.centre);
    error_bound = 32 * unit_roundoff<double> * (extent.reach + pose.translation.norm()) +
                  std::numeric_limits<double>::min();
  }
};

/// An upper bound on |R_to - R_from|_2.
inline double rotation_difference(const ReferencePose& from, const ReferencePose& to) {
  const double norm = (to.rotation - from.rotation).norm();
  const double defects = from.defect + to.defect;
  if (!(norm + defects < 1.9)) return norm;
  return std::min(norm, (norm + defects) * M_SQRT1_2 + defects);
}

/// An upper bound on the displacement of any point of a body between two poses; `rotation` bounds
/// |R_to - R_from|_2.
inline double step_between(const ReferencePose& from, const ReferencePose& to, double rotation,
                           double radius) {
  return ((to.centre - from.centre).norm() + rotation * radius) *
         (1 + 32 * unit_roundoff<double>)+(from.error_bound + to.error_bound);
}

}  // namespace bvlab
