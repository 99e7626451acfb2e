// SPDX-License-Identifier: BSD-3-Clause
/// Tests an oriented box against siblings of another body by fifteen separating axes. The nine edge
/// axes are tested only if the six face axes leave a lane open. One N_v: about 200 operations.
///
/// A box a = {c + sum s_i a_i, |s_i| <= h_i} is taken to the other body's frame by x -> Q x + t,
/// rounded to float: c' and a'_i. For any vector n the bodies' points are apart where
///
///   |n.T| > sum_i h_a,i |n.a'_i| + sum_j h_b,j |n.b_j| + |n| D,     T = c_b - c',
///
/// D being how far a point of a can be from where c' + sum s_i a'_i puts it. What follows bounds
/// all rounding errors in the fifteen inequalities as they are computed below. e = 2^-24,
/// |.| of a matrix is the 2-norm, second orders are left out and covered at the end.
///
/// Points. A component of c' or a'_i is a sum of three products of numbers, of which those of Q and
/// t are rounded: off by 4e of its terms, which over three components is less than 10e (|c| + |t|)
/// for c' and 7e for a'_i. So D = 10e (|c_a| + |t|) + 7e sum_i h_a,i + `error_bound` (see
/// RelativePose).
///
/// Axes. A stored box has |BB' - I| <= 4e (see obb.hpp). The rows a'_i are off by 7e each, 12.2e as
/// a matrix, so |A'A'' - I| <= 4e + 2 * 12.2e < 29e. The cosines c_ij = a'_i.b_j as computed are
/// off by 3e; a'_i.T by 3e |T| and, T being rounded, e |T| more: 4e |T|; b_j.T likewise.
///
/// Faces, n = a'_i: sum_k h_a,k |n.a'_k| exceeds h_a,i by 29e sum h_a. With five differences, each
/// off by e of |T| + h_a,i + sum h_b, the error is 9e |T| + 34e sum h_a + 8e sum h_b; for n = b_j
/// it is 9e |T| + 8e sum h_a + 9e sum h_b.
///
/// Edges, n = c_i1,j a'_i2 - c_i2,j a'_i1 with the c as computed (i1, i2 are i + 1, i + 2 modulo
/// 3): any n will do, so it has no error, and |n| <= 1. Then
/// - n.T = c_i1,j (a'_i2.T) - c_i2,j (a'_i1.T): off by 4e |T| of each product's factor, their
///   moduli summing to at most sqrt(2), and by two roundings: 9e |T|;
/// - |n.a'_i|, |n.a'_i1|, |n.a'_i2| are 0, |c_i2,j|, |c_i1,j| but for sqrt(2) 29e < 42e;
/// - |n.b_j|, |n.b_j1|, |n.b_j2| would be minors of the matrix of exact cosines C = A'B': 0 and the
///   two entries |C_i,j2|, |C_i,j1| if that were orthogonal. |CC' - I| <= 29e + 4e, so by the polar
///   factorisation C = PO with |P - I| <= 17e, cofactors differ from entries by |P^-1 det P - P| <=
///   51e; cosines as computed are off by 3e, in n by sqrt(2) 3e: 51e + 3e + 5e = 59e;
/// - six differences, each off by e of sqrt(2) |T| + sum h_a + sum h_b.
/// In all 18e |T| + 48e sum h_a + 65e sum h_b: the worst of the fifteen.
///
/// Lengths. sum h <= sqrt(3) |h|, and |c| + |h| <= r, the reach of the body; |T| <= |t| + |c_a| +
/// |c_b|. So with D the error is at most
///
///   28e |t| + (28e |c_a| + 96e |h_a|) + (18e |c_b| + 113e |h_b|) + error bound,
///
/// and margin = 128e (|t| + r_a + r_b) + error bound leaves an eighth for second orders. It has no
/// part that shrinks with n: near-parallel edges separate nothing. Underflow is covered by `tiny`,
/// which is added and whose square is still a normal number. Where the lengths could overflow a
/// square or a sum, the margin is infinite and nothing is found apart; nor is it where a
/// comparison has a NaN.
#pragma once

#include <array>
#include <limits>

#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/wide/sibling_test.hpp"

namespace bvlab {

template <>
struct ObbSiblingTest<float> {
  struct FrameChange {
    alignas(16) float column[3][4], translation[4];
    float margin;
  };
  /// One posed box, laid out to be broadcast from memory.
  struct PosedNode {
    alignas(16) float centre[4], axes[3][4], half[3];
    float size;
  };

  [[gnu::always_inline]] static FrameChange frame_change(const RelativePose& pose, double reach,
                                                         double reach_of_lanes) {
    constexpr double e = unit_roundoff<float>;
    FrameChange frame_change;
    for (int i = 0; i < 3; ++i)
      rounded_to_float(pose.column[static_cast<std::size_t>(i)])
          .copy_to(frame_change.column[i], stdx::vector_aligned);
    rounded_to_float(pose.translation).copy_to(frame_change.translation, stdx::vector_aligned);
    const double lengths = pose.length + reach + reach_of_lanes;
    frame_change.margin =
        lengths < 0x1p60
            ? static_cast<float>((128 * e * lengths + pose.error_bound) * (1 + 8 * e) + tiny)
            : std::numeric_limits<float>::infinity();
    return frame_change;
  }

  [[gnu::always_inline]] static PosedNode posed_node(const Obb<float>& box, float size,
                                                     const FrameChange& frame_change) {
    using Four = Batch<float, 4>;
    const auto from = [](const float* p) { return Four(p, stdx::vector_aligned); };
    PosedNode one;
    Four centre = from(frame_change.translation);
    for (int k = 0; k < 3; ++k)
      centre = fused<Four>(from(frame_change.column[k]), Four(box.centre[k]), centre);
    centre.copy_to(one.centre, stdx::vector_aligned);
    for (std::size_t i = 0; i < 3; ++i) {
      Four axis = from(frame_change.column[0]) * Four(box.axes[i][0]);
      axis = fused<Four>(from(frame_change.column[1]), Four(box.axes[i][1]), axis);
      axis = fused<Four>(from(frame_change.column[2]), Four(box.axes[i][2]), axis);
      axis.copy_to(one.axes[i], stdx::vector_aligned);
    }
    for (int k = 0; k < 3; ++k) one.half[k] = box.half[k];
    one.size = size;
#if defined(__GNUC__)
    // Forces loads from memory instead of shuffles out of registers, one by one.
    asm("" : "+m"(one));
#endif
    return one;
  }

  /// The same box in all lanes.
  template <Batched S>
  [[gnu::always_inline]] static Obb<S> in_lanes(const PosedNode& one) {
    Obb<S> box;
    for (int k = 0; k < 3; ++k) {
      box.centre[k] = S(one.centre[k]), box.half[k] = S(one.half[k]);
      for (std::size_t i = 0; i < 3; ++i) box.axes[i][k] = S(one.axes[i][k]);
    }
    return box;
  }
  /// One box per lane, posed from the other body's frame.
  template <Batched S>
  [[gnu::always_inline]] static Obb<S> in_lanes(const Obb<S>& boxes,
                                                const FrameChange& frame_change) {
    Obb<S> box;
    const auto& column = frame_change.column;
    for (int k = 0; k < 3; ++k) {
      const S x(column[0][k]), y(column[1][k]), z(column[2][k]);
      box.centre[k] =
          fused<S>(boxes.centre[2], z,
                   fused<S>(boxes.centre[1], y,
                            fused<S>(boxes.centre[0], x, S(frame_change.translation[k]))));
      for (std::size_t i = 0; i < 3; ++i)
        box.axes[i][k] =
            fused<S>(boxes.axes[i][2], z, fused<S>(boxes.axes[i][1], y, boxes.axes[i][0] * x));
      box.half[k] = boxes.half[k];
    }
    return box;
  }

  /// A lower bound on the gap along the best separating axis; negative where the boxes may overlap,
  /// and then the penetration along face axes. Axes are at most 1 + 26e long. Edge axes are skipped
  /// for lanes that face axes separate.
  template <Batched S>
  [[gnu::always_inline]] static S separation(const Obb<S>& one, const FrameChange& frame_change,
                                             const Obb<S>& lanes) {
    const Between<S> between(one, frame_change, lanes);
    return between.separation();
  }
  template <Batched S>
  [[gnu::always_inline]] static S separation(const PosedNode& one, const FrameChange& frame_change,
                                             const Obb<S>& lanes) {
    return separation<S>(in_lanes<S>(one), frame_change, lanes);
  }

  /// The order is the penetration relative to the sizes, deepest first.
  template <Batched S>
  [[gnu::always_inline]] static OverlapLanes<S> overlap(const Obb<S>& one,
                                                        const FrameChange& frame_change,
                                                        const Obb<S>& lanes, const S& sizes) {
    const Between<S> between(one, frame_change, lanes);
    const S faces = between.faces();
    return {between.apart(faces), faces * roughly_one_over<S>(sizes)};
  }
  template <Batched S>
  [[gnu::always_inline]] static OverlapLanes<S> overlap(const PosedNode& one,
                                                        const FrameChange& frame_change,
                                                        const Obb<S>& lanes, const S& sizes) {
    return overlap<S>(in_lanes<S>(one), frame_change, lanes, sizes);
  }

  /// A lower bound on the distance: of one box from the box around the other along its axes, or
  /// along an edge axis.
  template <Batched S>
  [[gnu::always_inline]] static S gaps(const Obb<S>& one, const FrameChange& frame_change,
                                       const Obb<S>& lanes) {
    const Between<S> between(one, frame_change, lanes);
    return between.gap();
  }
  template <Batched S>
  [[gnu::always_inline]] static S gaps(const PosedNode& one, const FrameChange& frame_change,
                                       const Obb<S>& lanes) {
    return gaps<S>(in_lanes<S>(one), frame_change, lanes);
  }

 private:
  static constexpr double tiny = 0x1p-61;

  /// Two boxes in one frame: `a` has been posed into the frame of `b`.
  template <Batched S>
  struct Between {
    const Obb<S>&a, &b;
    S margin;
    std::array<S, 3> along_a, along_b;  // T
    std::array<std::array<S, 3>, 3> cosine;

    [[gnu::always_inline]] Between(const Obb<S>& one, const FrameChange& frame_change,
                                   const Obb<S>& lanes)
        : a(one), b(lanes), margin(frame_change.margin) {
      const Vec3<S> t(b.centre[0] - a.centre[0], b.centre[1] - a.centre[1],
                      b.centre[2] - a.centre[2]);
      for (std::size_t i = 0; i < 3; ++i) {
        along_a[i] = product(a.axes[i], t), along_b[i] = product(b.axes[i], t);
        for (std::size_t j = 0; j < 3; ++j) cosine[i][j] = product(a.axes[i], b.axes[j]);
      }
    }

    [[gnu::always_inline]] static S product(const Vec3<S>& x, const Vec3<S>& y) {
      return fused<S>(x[2], y[2], fused<S>(x[1], y[1], x[0] * y[0]));
    }

    [[gnu::always_inline]] S face_a(std::size_t i) const {
      S beyond = stdx::abs(along_a[i]) - a.half[static_cast<int>(i)];
      for (std::size_t j = 0; j < 3; ++j)
        beyond = less_fused<S>(b.half[static_cast<int>(j)], stdx::abs(cosine[i][j]), beyond);
      return beyond;
    }
    [[gnu::always_inline]] S face_b(std::size_t j) const {
      S beyond = stdx::abs(along_b[j]) - b.half[static_cast<int>(j)];
      for (std::size_t i = 0; i < 3; ++i)
        beyond = less_fused<S>(a.half[static_cast<int>(i)], stdx::abs(cosine[i][j]), beyond);
      return beyond;
    }
    [[gnu::always_inline]] S faces() const {
      using stdx::max;
      return max(max(max(face_a(0), face_b(0)), max(face_a(1), face_b(1))),
                 max(face_a(2), face_b(2))) -
             margin;
    }

    [[gnu::always_inline]] S edge(std::size_t i, std::size_t j) const {
      using stdx::abs;
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      S beyond =
          abs(less_fused<S>(cosine[i2][j], along_a[i1], cosine[i1][j] * along_a[i2])) - margin;
      beyond = less_fused<S>(a.half[static_cast<int>(i1)], abs(cosine[i2][j]), beyond);
      beyond = less_fused<S>(a.half[static_cast<int>(i2)], abs(cosine[i1][j]), beyond);
      beyond = less_fused<S>(b.half[static_cast<int>(j1)], abs(cosine[i][j2]), beyond);
      return less_fused<S>(b.half[static_cast<int>(j2)], abs(cosine[i][j1]), beyond);
    }
    [[gnu::always_inline]] S edges() const {
      using stdx::max;
      S most = edge(0, 0);
#pragma GCC unroll 8
      for (std::size_t k = 1; k < 9; ++k) most = max(most, edge(k / 3, k % 3));
      return most;
    }

    [[gnu::always_inline]] Mask<S> apart(const S& faces) const {
      Mask<S> apart = faces > S(0.0f);
      if (!stdx::all_of(apart)) apart = apart || edges() > S(0.0f);
      return apart;
    }
    [[gnu::always_inline]] S separation() const {
      const S faces = this->faces();
      const Mask<S> apart = faces > S(0.0f);
      if (stdx::all_of(apart)) return faces * S(below);
      const S edges = this->edges();
      return select(edges > S(0.0f) && !apart, edges, faces) * S(below);
    }
    [[gnu::always_inline]] S gap() const {
      using stdx::max, stdx::min, stdx::sqrt;
      const S zero(0.0f);
      S squared_a = zero, squared_b = zero;
      for (std::size_t i = 0; i < 3; ++i) {
        const S x = face_a(i) - margin, y = face_b(i) - margin;
        // Written so that NaN counts as no gap.
        const S p = select(x > zero, x, zero), q = select(y > zero, y, zero);
        squared_a = fused<S>(p, p, squared_a), squared_b = fused<S>(q, q, squared_b);
      }
      const S faces = sqrt(max(squared_a, squared_b));
      const S edges = this->edges();
      return max(faces, select(edges > zero, edges, zero)) * S(below);
    }

    /// Covers the lengths of the axes, and four roundings.
    static constexpr float below = 1 - 64 * unit_roundoff<float>;
  };
};

}  // namespace bvlab
