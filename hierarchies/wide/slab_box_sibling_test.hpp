// SPDX-License-Identifier: BSD-3-Clause
/// Tests one slab-box, posed into another body's frame, against siblings of that body by eight
/// separating axes, six of faces and two of slabs. One N_v is about 70 operations, each for all
/// lanes at once.
///
/// The box a is rotated by Q and moved by t (FrameChange); its axes are Q's columns q_i. With T the
/// vector from its centre to a lane's, h half lengths, n normals, m slab centres (`slab_centre`)
/// and w widths, they are apart where
///   |T_j|                > h_b,j + sum_i |q_ij| h_a,i             (faces of b)
///   |q_i.T|              > h_a,i + sum_j |q_ij| h_b,j             (faces of a)
///   |n_b.T + m_b|        > w_b   + sum_i |n_b.q_i| h_a,i          (slab of b)
///   |Q n_a.T - m_a|      > w_a   + sum_j |(Q n_a)_j| h_b,j        (slab of a)
/// for any Q, so orthogonality is not needed: the error of Q is in the margin.
///
/// Margin. a is grown by a sphere of radius `slack` (see Placement), which reaches slack (1 + 2e)
/// along a normal. With e the unit roundoff, to first order: T is off by e |T|; q_i.T by (5.2
/// + 3.5) e |T| for its three products, q's rounding and T's; n_b.T by 7 e |T| and m_b's sum by e
/// r_b; n_b.q_i by 7e, Q n_a by 7e as a vector and its product with T by 16 e |T|; sums of half
/// lengths by 12 e of them, each at most sqrt(3) of its body's reach r. That is less than 16 e |T|
/// + 24 e (r_a + r_b), and |T| <= |t| + r_a + r_b (1 + ...): `margin` = slack + 64 e (|t| + r_a +
/// r_b) leaves a third for higher orders. Where lengths reach 2^100, sums and products may
/// overflow: then the margin is infinite, and nothing is found apart.
///
/// Tried and not kept: without vector registers, to test one lane after the other and end each test
/// at the first axis that separates. Runs from the roots took 1.08 to 1.40 times as long,
/// presumably by mispredicted branches.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "hierarchies/volumes/slab_box.hpp"
#include "hierarchies/wide/sibling_test.hpp"

namespace bvlab {

template <>
struct SlabBoxSiblingTest<float> {
  struct FrameChange {
    alignas(16) float column[3][4], absolute[3][4], translation[4];
    float margin;
  };
  /// One posed slab-box: all numbers that are broadcast to all lanes, contiguous in memory, from
  /// where a broadcast is free.
  struct PosedNode {
    alignas(16) float centre[4], reached[4], normal[4], absolute[4];
    float half[3], grown[3], slab_centre, width, size;
  };

  [[gnu::always_inline]] static FrameChange frame_change(const RelativePose& pose, double reach,
                                                         double reach_of_lanes) {
    constexpr double e = unit_roundoff<float>;
    FrameChange frame_change;
    using Four = Batch<float, 4>;
    for (int i = 0; i < 3; ++i) {
      const Four column = rounded_to_float(pose.column[static_cast<std::size_t>(i)]);
      column.copy_to(frame_change.column[i], stdx::vector_aligned);
      abs(column).copy_to(frame_change.absolute[i], stdx::vector_aligned);
    }
    rounded_to_float(pose.translation).copy_to(frame_change.translation, stdx::vector_aligned);
    // The `slack` of Placement, and the other terms.
    const double lengths = pose.length + reach + reach_of_lanes;
    frame_change.margin =
        lengths < 0x1p100
            ? static_cast<float>((74 * e * lengths + pose.error_bound) * (1 + 8 * e) +
                                 std::ldexp(1.0, std::numeric_limits<float>::min_exponent / 2 + 2))
            : std::numeric_limits<float>::infinity();
    return frame_change;
  }

  [[gnu::always_inline]] static PosedNode posed_node(const SlabBox<float>& box, float size,
                                                     const FrameChange& frame_change) {
    using Four = Batch<float, 4>;
    const auto from = [](const float* p) { return Four(p, stdx::vector_aligned); };
    Four centre = from(frame_change.translation), reached(frame_change.margin), normal(0.0f);
    for (int i = 0; i < 3; ++i) {
      centre = fused<Four>(from(frame_change.column[i]), Four(box.centre[i]), centre);
      reached = fused<Four>(from(frame_change.absolute[i]), Four(box.half[i]), reached);
      normal = fused<Four>(from(frame_change.column[i]), Four(box.normal[i]), normal);
    }
    PosedNode one;
    centre.copy_to(one.centre, stdx::vector_aligned);
    reached.copy_to(one.reached, stdx::vector_aligned);
    normal.copy_to(one.normal, stdx::vector_aligned);
    abs(normal).copy_to(one.absolute, stdx::vector_aligned);
    for (int i = 0; i < 3; ++i) {
      one.half[i] = box.half[i];
      one.grown[i] = box.half[i] + frame_change.margin;
    }
    one.slab_centre = box.slab_centre, one.width = box.width + frame_change.margin, one.size = size;
#if defined(__GNUC__)
    // Forces loads from memory instead of shuffles out of registers, one by one.
    asm("" : "+m"(one));
#endif
    return one;
  }

  /// A posed slab-box in each lane; the numbers of a PosedNode.
  template <Batched S>
  struct PosedLanes {
    std::array<S, 3> centre, reached, normal, absolute, half, grown;
    S slab_centre, width;
  };
  template <Batched S>
  [[gnu::always_inline]] static PosedLanes<S> in_lanes(const SlabBox<S>& boxes,
                                                       const FrameChange& frame_change) {
    PosedLanes<S> one;
    for (std::size_t k = 0; k < 3; ++k) {
      S centre(frame_change.translation[k]), reached(frame_change.margin), normal(0.0f);
      for (int i = 0; i < 3; ++i) {
        centre = fused<S>(S(frame_change.column[i][k]), boxes.centre[i], centre);
        reached = fused<S>(S(frame_change.absolute[i][k]), boxes.half[i], reached);
        normal = fused<S>(S(frame_change.column[i][k]), boxes.normal[i], normal);
      }
      one.centre[k] = centre, one.reached[k] = reached, one.normal[k] = normal;
      one.absolute[k] = stdx::abs(normal);
      one.half[k] = boxes.half[static_cast<int>(k)];
      one.grown[k] = one.half[k] + S(frame_change.margin);
    }
    one.slab_centre = boxes.slab_centre, one.width = boxes.width + S(frame_change.margin);
    return one;
  }

  /// A lower bound on the gap along the best separating axis; negative where they may overlap, and
  /// then the penetration. `One` is a PosedNode or PosedLanes.
  template <Batched S, class One>
  [[gnu::always_inline]] static S separation(const One& one, const FrameChange& frame_change,
                                             const SlabBox<S>& lanes) {
    using stdx::abs, stdx::max;
    const S x = lanes.centre[0] - S(one.centre[0]), y = lanes.centre[1] - S(one.centre[1]),
            z = lanes.centre[2] - S(one.centre[2]);
    S faces_b = (abs(x) - S(one.reached[0])) - lanes.half[0];
    faces_b = max(faces_b, (abs(y) - S(one.reached[1])) - lanes.half[1]);
    faces_b = max(faces_b, (abs(z) - S(one.reached[2])) - lanes.half[2]);

    S slab_b =
        fused<S>(lanes.normal[2], z,
                 fused<S>(lanes.normal[1], y, fused<S>(lanes.normal[0], x, lanes.slab_centre)));
    slab_b = (abs(slab_b) - lanes.width) - S(frame_change.margin);
    const auto along = [&](int i) __attribute__((always_inline)) {
      const S p(frame_change.column[i][0]), q(frame_change.column[i][1]),
          r(frame_change.column[i][2]);
      const S normal =
          fused<S>(lanes.normal[2], r, fused<S>(lanes.normal[1], q, lanes.normal[0] * p));
      slab_b = less_fused<S>(abs(normal), S(one.half[i]), slab_b);
      S face = abs(fused<S>(z, r, fused<S>(y, q, x * p))) - S(one.grown[i]);
      face = less_fused<S>(lanes.half[0], S(frame_change.absolute[i][0]), face);
      face = less_fused<S>(lanes.half[1], S(frame_change.absolute[i][1]), face);
      return less_fused<S>(lanes.half[2], S(frame_change.absolute[i][2]), face);
    };
    const S face_0 = along(0), face_1 = along(1), face_2 = along(2);

    S slab_a = fused<S>(z, S(one.normal[2]), fused<S>(y, S(one.normal[1]), x * S(one.normal[0])));
    slab_a = abs(slab_a - S(one.slab_centre)) - S(one.width);
    slab_a = less_fused<S>(lanes.half[0], S(one.absolute[0]), slab_a);
    slab_a = less_fused<S>(lanes.half[1], S(one.absolute[1]), slab_a);
    slab_a = less_fused<S>(lanes.half[2], S(one.absolute[2]), slab_a);
    return max(max(max(faces_b, face_0), max(face_1, face_2)), max(slab_a, slab_b));
  }

  /// A lower bound on the gap from a volume of body b to each of the triangles of a in the lanes;
  /// negative where they may overlap. `triangles` is a TransformedLeaf: corners within `off`, boxes
  /// grown by more than 2 off. A bound of the volume's box is off by e r_b < off / 2. Along the
  /// slab's normal n: a corner is off by |n_x| + |n_y| + |n_z| < 1.8 times off; n.c + m, of four
  /// terms, whose moduli sum to at most 3.1 r_b, by 13 e r_b < 6.5 off; three more roundings by
  /// 3.1 e (r_a + |t|) + 9.4 e r_b < 5 off. 16 off is more than all.
  template <Batched S, class Triangles>
  [[gnu::always_inline]] static S triangle_gaps(const SlabBox<float>& one,
                                                const Triangles& triangles) {
    using stdx::max, stdx::min;
    const auto lanes = [](const auto& x) { return S(x.data(), stdx::vector_aligned); };
    S gap(-std::numeric_limits<float>::infinity());
    for (std::size_t k = 0; k < 3; ++k) {
      const int i = static_cast<int>(k);
      gap = max(gap, S(one.centre[i] - one.half[i]) - lanes(triangles.high()[k]));
      gap = max(gap, lanes(triangles.low()[k]) - S(one.centre[i] + one.half[i]));
    }
    const float slab = -(one.normal[0] * one.centre[0] + one.normal[1] * one.centre[1] +
                         one.normal[2] * one.centre[2] + one.slab_centre);
    const auto along = [&](std::size_t i) __attribute__((always_inline)) {
      const auto& corner = triangles.corners().corner[i];
      return fused<S>(lanes(corner[2]), S(one.normal[2]),
                      fused<S>(lanes(corner[1]), S(one.normal[1]),
                               fused<S>(lanes(corner[0]), S(one.normal[0]), S(slab))));
    };
    const S p = along(0), q = along(1), r = along(2);
    const S beyond = max(min(min(p, q), r), -max(max(p, q), r));
    return max(gap, (beyond - S(one.width)) - S(16 * triangles.off()));
  }

  /// The order is the penetration relative to the sizes, deepest first.
  template <Batched S, class One>
  [[gnu::always_inline]] static OverlapLanes<S> overlap(const One& one,
                                                        const FrameChange& frame_change,
                                                        const SlabBox<S>& lanes, const S& sizes) {
    const S apart = separation<S>(one, frame_change, lanes);
    return {apart > S(0.0f), apart * roughly_one_over<S>(sizes)};
  }

  /// A lower bound on the distance: of boxes along the axes of one of them, or of a slab. Axes and
  /// normals are at most 1 + 4e long, and fewer than ten roundings are made.
  template <Batched S, class One>
  [[gnu::always_inline]] static S gaps(const One& one, const FrameChange& frame_change,
                                       const SlabBox<S>& lanes) {
    using stdx::abs, stdx::max, stdx::min, stdx::sqrt;
    const S zero(0.0f);
    S squared_b = zero, squared_a = zero;
    const Vec3<S> between(lanes.centre[0] - S(one.centre[0]), lanes.centre[1] - S(one.centre[1]),
                          lanes.centre[2] - S(one.centre[2]));
    for (int i = 0; i < 3; ++i) {
      const S face_b = (abs(between[i]) - S(one.reached[i])) - lanes.half[i];
      S face_a = zero;
      for (int j = 0; j < 3; ++j)
        face_a = fused<S>(between[j], S(frame_change.column[i][j]), face_a);
      face_a = abs(face_a) - S(one.grown[i]);
      for (int j = 0; j < 3; ++j)
        face_a = less_fused<S>(lanes.half[j], S(frame_change.absolute[i][j]), face_a);
      // Written so that NaN counts as no gap.
      const S b = select(face_b > zero, face_b, zero), a = select(face_a > zero, face_a, zero);
      squared_b = fused<S>(b, b, squared_b), squared_a = fused<S>(a, a, squared_a);
    }
    const S largest(std::numeric_limits<float>::max());
    const S boxes = sqrt(min(largest, max(squared_a, squared_b)));
    const S apart = separation<S>(one, frame_change, lanes);
    return max(boxes, select(apart > zero, apart, zero)) * S(1 - 32 * unit_roundoff<float>);
  }
};

}  // namespace bvlab
