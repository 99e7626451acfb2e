// SPDX-License-Identifier: BSD-3-Clause
/// The pose of one body relative to another, and a bound on its error.
///
/// Let w_a = fl64(R_a v + t_a) be a vertex of a in the world, w_b one of b, and u =
/// 2^-53. Let Q_a, Q_b be matrices with |Q'Q - I| <= 32u next to the rotations (R itself where that
/// is so, see Placement), and P_b the orthonormal matrix nearest Q_b, |P_b - Q_b| <= 17u. The map
///
///   x -> P_b' (x - t_b)
///
/// is rigid: two triangles of the world share a point exactly where their images do, and are as far
/// apart. It takes
///
///   w_a  to within  8u (r_a + |t_a|) + |R_a - Q_a| r_a + 17u (r_a + |t_a - t_b|)
///        of  Q_b' Q_a v + Q_b' (t_a - t_b)           (|v| <= r_a, the reach of a),
///   w_b  to within  8u (r_b + |t_b|) + |R_b - Q_b| r_b + (17u + 32u) r_b   of  v.
///
/// The product Q_b' Q_a is computed in float64 with at most three roundings of each product in a
/// component, and the vector with four. As the matrix of the moduli of Q has norm 5/3 at most, that
/// is less than 9u (r_a + |t_a - t_b|) in all. `error_bound` is at least the sum of all these
/// errors, so that b may be taken to be exactly where its mesh is given, and a within `error_bound`
/// of where rotation and translation put it. All of it is below 64u of the lengths: float volumes
/// round much more, unless bodies are far from the origin of the world; but there float64 poses are
/// as inexact. Of a mesh about an origin of its own, v and t are local, and 8u (r + |t|) is the
/// error of LocalPose.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "hierarchies/geometry/local_pose.hpp"
#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/small_matrices.hpp"

namespace bvlab {

/// The part of a relative pose that depends on one body; computed once per move.
struct OrthonormalPose {
  using Four = Batch<double, 4>;

  alignas(32) double rows[3][4] = {};  ///< of Q, orthonormal to 32u, each padded by 0
  Vec3<double> translation = Vec3<double>::Zero();
  double reach = 0;        ///< of the mesh, from its own origin
  double error_bound = 0;  ///< 8u (r + |t|) + |R - Q| r; infinite where R is off by more than 0.01

  OrthonormalPose() = default;
  /// Of a mesh about `origin`, of which the translation, then, is that.
  OrthonormalPose(const Pose& pose, double reach_of_mesh,
                  const Vec3<double>& origin = Vec3<double>::Zero())
      : translation(pose.translation), reach(reach_of_mesh) {
    constexpr double u = unit_roundoff<double>;
    if (LocalMesh::has_own_origin(origin)) [[unlikely]] {
      const LocalPose local(pose, origin, reach);
      translation = local.pose.translation, error_bound = local.error;
    } else {
      error_bound = 8 * u * (reach + translation.lpNorm<1>());
    }
    if (squared_defect_of(pose.rotation) <= sound)
      keep(pose.rotation);
    else
      keep(made_orthonormal(pose.rotation));
  }

  /// Q' v for v = (x, y, z); the fourth number is 0.
  [[gnu::always_inline]] Four transposed_times(double x, double y, double z) const {
    const auto row = [&](int i) { return Four(rows[i], stdx::vector_aligned); };
    return (row(0) * Four(x) + row(1) * Four(y)) + row(2) * Four(z);
  }

 private:
  static constexpr double sound = 32 * 32 * unit_roundoff<double> * unit_roundoff<double>;

  void keep(const Mat3<double>& rotation) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rows[i][j] = rotation(i, j);
  }

  Mat3<double> made_orthonormal(const Mat3<double>& given) {
    Mat3<double> rotation = given;
    double left = squared_defect_of(rotation);
    // As in Placement, each step of Newton's iteration squares the defect.
    if (left <= 1e-4)
      for (int step = 0; step < 8 && !(left <= sound); ++step) {
        rotation = towards_orthonormal(rotation);
        left = squared_defect_of(rotation);
      }
    if (left <= sound) {
      error_bound += ((given - rotation).norm() + 8 * unit_roundoff<double>)*reach;
      return rotation;
    }
    error_bound = std::numeric_limits<double>::infinity();
    return Mat3<double>::Identity();
  }

  /// |M'M - I|_F^2.
  static double squared_defect_of(const Mat3<double>& m) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double own = dot<double>(m.col(i), m.col(i)) - 1;
      const double next = dot<double>(m.col(i), m.col((i + 1) % 3));
      sum += own * own + 2 * (next * next);
    }
    return sum;
  }
};

/// The pose of body a in the frame of body b.
struct RelativePose {
  using Four = OrthonormalPose::Four;

  std::array<Four, 3> column;  ///< of the rotation; the last number of each is 0
  Four translation;
  double length;  ///< 1-norm of the translation
  double error_bound;

  RelativePose(const OrthonormalPose& a, const OrthonormalPose& b) {
    const double x = a.translation[0] - b.translation[0], y = a.translation[1] - b.translation[1],
                 z = a.translation[2] - b.translation[2];
    for (std::size_t j = 0; j < 3; ++j)
      column[j] = b.transposed_times(a.rows[0][j], a.rows[1][j], a.rows[2][j]);
    translation = b.transposed_times(x, y, z);
    length = (std::abs(translation[0]) + std::abs(translation[1])) + std::abs(translation[2]);
    error_bound = a.error_bound + b.error_bound +
                  128 * unit_roundoff<double> *
                      (a.reach + b.reach + ((std::abs(x) + std::abs(y)) + std::abs(z)));
  }

  Mat3<double> rotation() const {
    Mat3<double> matrix;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        matrix(i, j) = column[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
    return matrix;
  }
  Vec3<double> shift() const { return {translation[0], translation[1], translation[2]}; }
};

}  // namespace bvlab
