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
/// what both bodies have rotated by since, and 2. The margin of a verdict on triangles lasts as
/// long, since no point of one has moved by more relative to the other.
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
#include <cstddef>
#include <limits>
#include <vector>

#include "traversal/reference_sphere.hpp"

namespace bvlab {

class MeasuredGaps {
 public:
  static constexpr int width = std::clamp(native_width<float>, 4, 16);
  using S = Batch<float, width>;

  std::size_t size() const { return size_; }
  void clear() { measured_.clear(), size_ = 0; }
  /// Adds one that is not known.
  void add() {
    if (size_ % width == 0) measured_.emplace_back();
    forget(size_++);
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
    to.rotation[lane] = static_cast<float>(rotation) * (1 - 2 * unit_roundoff<float>);
    to.gap[lane] = gap - 8 * reference.error_bound;
  }
  /// Makes a gap that was set at these poses smaller, never larger.
  void lower(std::size_t i, float gap, float error_bound) {
    float& least = measured_[i / width].gap[i % width];
    const float other = gap - 8 * error_bound;
    least = other < least ? other : other >= least ? least : unknown;  // NaN
  }
  void forget(std::size_t i) { measured_[i / width].gap[i % width] = unknown; }
  /// The gap when it was measured, less what rounding may add; not positive where none is known.
  float operator[](std::size_t i) const { return measured_[i / width].gap[i % width]; }

  /// Lower bounds on what is left of the gaps `first` and up, `first` a multiple of `width`; not
  /// positive where no gap is known.
  [[gnu::always_inline]] S remaining(std::size_t first, const CornerTransform& a_to_b,
                                     double rotation) const {
    using stdx::min, stdx::sqrt;
    constexpr float e = unit_roundoff<float>;
    const Measured& from = measured_[first / width];
    const auto lanes = [](const Lanes& x) { return S(x.data(), stdx::vector_aligned); };
    const auto now = a_to_b(lanes(from.of_a[0]), lanes(from.of_a[1]), lanes(from.of_a[2]));
    S squared(0x1p-120f);
    for (std::size_t k = 0; k < 3; ++k) {
      const S moved = now[k] - lanes(from.of_b[k]);
      squared = fused<S>(moved, moved, squared);
    }
    const S rotated =
        min(S(static_cast<float>(rotation) * (1 + 2 * e)) - lanes(from.rotation), S(2.0f + 16 * e));
    const S nearer = sqrt(squared) * S(1 + 16 * e) + rotated * lanes(from.radius) * S(1 + 4 * e);
    return (lanes(from.gap) - nearer) - S(8 * a_to_b.error_bound());
  }

 private:
  // Not 0: where the sum of rotations has fallen, as from one pair of bodies to another, something
  // would be left of a gap of 0.
  static constexpr float unknown = -std::numeric_limits<float>::infinity();

  using Lanes = std::array<float, width>;
  /// The gaps of `width` entries.
  struct alignas(sizeof(float) * width) Measured {
    std::array<Lanes, 3> of_a{}, of_b{};
    Lanes radius{}, rotation{}, gap{};  // all 0 in an unused lane: nothing is left there
  };

  std::vector<Measured> measured_;
  std::size_t size_ = 0;
};

}  // namespace bvlab
