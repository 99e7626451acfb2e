// SPDX-License-Identifier: BSD-3-Clause
/// For each entry of a front, a lower bound on its gap and the sphere at which it was measured.
/// From the present poses follows a lower bound on the remaining gap, for a register of entries at
/// once. An entry whose gap is used up is due for a test.
///
/// How long a gap lasts. One of the two nodes is represented by its sphere, of centre y and radius
/// r. Let x -> Tx take points of a to the frame of b, M its rotation, T' and M' the same now. If
/// the sphere is a's, each of its points x, and with it every triangle in it, has since come nearer
/// to anything of b by at most
///
///   |T'x - Tx| <= |T'y - Ty| + |M' - M|_2 r,
///
/// whatever path the bodies took. If it is b's, y is the point of a at its centre: T'^-1 Ty - y =
/// -M'^-1 (T'y - Ty), and the inverse rotations differ as the rotations do. |M' - M| is at most
/// 2, and at most the sum of both bodies' rotations since. The margin of a verdict on triangles
/// lasts as long, since no point of one has moved by more relative to the other.
///
/// Tried and not kept: one expiry for each entry, from the displacement bounds of whole bodies. The
/// comparison is cheaper, but margins made 2.3 to 2.8 times the tests of volumes and of triangles
/// (contacts, 0.03 and 0.3 degrees a frame).
///
/// Rounding, with e = 2^-24. Let d be the error bound of any coordinate of T'y (CornerTransform),
/// and d_0 that of Ty, when the gap was measured. y and Ty, as they are kept, correspond to each
/// other to within sqrt(3) d_0; T'y has an error below sqrt(3) d. (d is for points of a; a centre
/// of b lies at most r_b + |t| from a's origin, and what that adds is below 2 d_0 + d.) Bodies'
/// poses are not quite orthonormal. That adds at most 3p to a sphere and to the difference of the
/// rotations, p being the sum of both poses' error bounds, and p < d. 8 d_0 + 8 d cover all.
/// Differences, squares and the root are off by fewer than 16 e of themselves; squares that
/// underflow by less than 2^-60 after the root, which is added as 2^-120 under it, and covers a
/// radius that underflowed, too. Rotations are summed up in double and rounded to float: 2e of
/// each. NaN counts as no gap.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "traversal/reference_sphere.hpp"

namespace bvlab {

/// A float below x, also where x exceeds the largest float: half a unit in the last place is lost
/// to each of two roundings; the last term covers underflow. A number below all floats gives
/// minus infinity.
inline float just_below(double x) {
  constexpr double largest = std::numeric_limits<float>::max();
  const auto y = static_cast<float>(std::max(std::min(x, largest), -largest));
  return y - std::abs(y) * 0x1p-22f - std::numeric_limits<float>::min();
}
inline float just_above(double x) { return -just_below(-x); }

template <int kWidth>
class MeasuredGapsOf {
 public:
  static constexpr int width = kWidth;
  using S = Batch<float, width>;

  std::size_t size() const { return size_; }
  void clear() { measured_.clear(), size_ = 0; }
  /// Adds an unknown gap.
  void add() {
    if (size_ % width == 0) [[unlikely]]
      measured_.emplace_back();
    ++size_;
  }

  /// Sets a gap, the sphere at which it was measured, and the sum of the bounds on both bodies'
  /// rotations since the first frame.
  void set(std::size_t i, float gap, const ReferenceSphere& reference, double rotation) {
    Measured& to = measured_[i / width];
    const std::size_t lane = i % width;
    for (std::size_t k = 0; k < 3; ++k) {
      to.of_a[k][lane] = reference.centre_in[0][k];
      to.of_b[k][lane] = reference.centre_in[1][k];
    }
    to.radius[lane] = reference.radius;
    to.rotation[lane] = rounded_down(rotation);
    to.gap[lane] = gap - 8 * reference.error_bound;
  }
  /// Makes a gap smaller, never larger, that was set at the present poses; `error_bound` is that of
  /// coordinates in the other body's frame.
  void lower_measured(std::size_t i, float gap, float error_bound) {
    float& least = measured_[i / width].gap[i % width];
    const float lowered = gap - 8 * error_bound;
    if (!(lowered >= least)) least = lowered;
  }
  void forget(std::size_t i) {
    Measured& at = measured_[i / width];
    at.gap[i % width] = unknown, at.radius[i % width] = 0;
  }

  /// Forgets those of the `width` gaps from `first` on whose lanes are set in a mask; `first` is a
  /// multiple of `width`, and none of them may be announced.
  void forget(std::size_t first, const typename S::mask_type& these) {
    put(measured_[first / width].gap, these, S(unknown));
  }

  // Finding one sphere at a time cost 25 ns per gap and made margins in fast motion 1.4 times as
  // slow. So tests only announce gaps, and measure() then finds the spheres of `width` at once.

  /// Whether a gap lies between two volumes or is the least margin of tested triangles.
  enum class Of { volumes, triangles };
  /// Announces a gap: it is unknown until measure() finds its sphere.
  [[gnu::always_inline]] void announce(std::size_t i, float gap, Of what) {
    Measured& at = measured_[i / width];
    at.gap[i % width] = unknown;
    at.radius[i % width] = what == Of::volumes ? of_volumes : of_triangles;
    at.rotation[i % width] = gap;
  }
  /// Makes a gap smaller, never larger, that has been announced and not yet measured.
  void lower(std::size_t i, float gap) {
    float& least = measured_[i / width].rotation[i % width];
    least = gap < least ? gap : gap >= least ? least : unknown;  // a NaN gap is unknown
  }
  /// Finds the spheres of those of the `width` gaps from `first` on that were announced at the
  /// present poses; forgets those of volumes below `useful`. sphere(0, k) and sphere(1, k) point to
  /// the spheres of the two nodes of gap first + k, also where it is not announced. Returns the
  /// least of these gaps: infinity where none was announced, 0 where one is forgotten or used up by
  /// rounding.
  template <class SphereOf>
  [[gnu::always_inline]] float measure(std::size_t first,
                                       const std::array<CornerTransform, 2>& transforms,
                                       double rotation, float useful, const SphereOf& sphere) {
    Measured& at = measured_[first / width];
    const S mark = batch(at.radius), gap = batch(at.rotation);
    const auto announced = mark < S(0.0f), stays = !(gap < S(useful)) || mark < S(of_volumes);
    const auto spheres = reference_spheres_of_smaller<S>(sphere, transforms);
    for (std::size_t k = 0; k < 3; ++k) {
      put(at.of_a[k], announced, spheres.centre_in[0][k]);
      put(at.of_b[k], announced, spheres.centre_in[1][k]);
    }
    const S known = select(stays, gap - S(8.0f) * spheres.error_bound, S(unknown));
    put(at.gap, announced, known);
    put(at.rotation, announced, S(rounded_down(rotation)));
    put(at.radius, announced, spheres.radius);
    const S left = select(known > S(0.0f), known, S(0.0f));
    return stdx::hmin(select(announced, left, S(std::numeric_limits<float>::infinity())));
  }

  /// The gap when it was measured, less what rounding may add; not positive where none is known.
  float operator[](std::size_t i) const { return measured_[i / width].gap[i % width]; }

  /// Begins to load gap i, if there is one, and those beside it.
  void prefetch(std::size_t i) const {
    if (i < size_)
      for (std::size_t at = 0; at < sizeof(Measured); at += 64)
        __builtin_prefetch(reinterpret_cast<const char*>(&measured_[i / width]) + at);
  }

  /// Lower bounds on what is left of the gaps `first` and up, `first` a multiple of `width`; not
  /// positive where no gap is known.
  [[gnu::always_inline]] S remaining(std::size_t first, const CornerTransform& a_to_b,
                                     double rotation) const {
    using stdx::min, stdx::sqrt;
    constexpr float e = unit_roundoff<float>;
    const Measured& from = measured_[first / width];
    const auto now = a_to_b(batch(from.of_a[0]), batch(from.of_a[1]), batch(from.of_a[2]));
    S squared(0x1p-120f);
    for (std::size_t k = 0; k < 3; ++k) {
      const S moved = now[k] - batch(from.of_b[k]);
      squared = fused<S>(moved, moved, squared);
    }
    const S rotated =
        min(S(static_cast<float>(rotation) * (1 + 2 * e)) - batch(from.rotation), S(2.0f + 16 * e));
    const S nearer = sqrt(squared) * S(1 + 16 * e) + rotated * batch(from.radius) * S(1 + 4 * e);
    return (batch(from.gap) - nearer) - S(8 * a_to_b.error_bound());
  }

 private:
  // Not 0: where the sum of rotations has fallen, as from one pair of bodies to another, something
  // would be left of a gap of 0.
  static constexpr float unknown = -std::numeric_limits<float>::infinity();

  // A negative radius marks an announced gap, which `rotation` holds until it is measured.
  static constexpr float of_volumes = -1, of_triangles = -2;

  static float rounded_down(double rotation) {
    return static_cast<float>(rotation) * (1 - 2 * unit_roundoff<float>);
  }

  using Lanes = std::array<float, width>;
  [[gnu::always_inline]] static S batch(const Lanes& x) {
    return S(x.data(), stdx::vector_aligned);
  }
  [[gnu::always_inline]] static void put(Lanes& to, const typename S::mask_type& these,
                                         const S& x) {
    select(these, x, batch(to)).copy_to(to.data(), stdx::vector_aligned);
  }
  /// The gaps of `width` entries.
  struct alignas(sizeof(float) * width) Measured {
    std::array<Lanes, 3> of_a{}, of_b{};
    Lanes radius{}, rotation{}, gap;
    Measured() { gap.fill(unknown); }
  };

  std::vector<Measured> measured_;
  std::size_t size_ = 0;
};

using MeasuredGaps = MeasuredGapsOf<std::clamp(native_width<float>, 4, 16)>;
/// For short lists, as the margins of hits: a register of four wastes less memory.
using FewMeasuredGaps = MeasuredGapsOf<4>;

}  // namespace bvlab
