// SPDX-License-Identifier: BSD-3-Clause
/// The front of two wide trees: every step of the traversal that found the bodies apart, with the
/// lanes that were opened, how far apart the others were and where that was; and every triangle
/// that was tested against a leaf, with the same once it has been measured.
///
/// Law: every pair of triangles lies below a lane that is not opened of exactly one entry, or is in
/// one of triangles.
///
/// For how long. Of the two nodes one is compared by its ball, of middle y and radius r. Let x ->
/// Tx be where b has the points of a, M its rotation, T' and M' the same now. If the ball is a's,
/// each of its points x, and with it every triangle in it, has since come nearer to anything of b
/// by
///
///   |T'x - Tx| <= |T'y - Ty| + |M' - M|_2 r
///
/// at most, whatever way the bodies took. If it is b's, y stands for the point of a at its middle:
/// T'^-1 Ty - y = -M'^-1 (T'y - Ty), and the inverse rotations differ as the rotations do. |M' - M|
/// is at most what both bodies have turned by since, and 2.
///
/// Rounding, with e = 2^-24 and `off` by which any coordinate of T'y is off (CornersBetween). y and
/// Ty, as they are kept, belong together to within sqrt(3) off of then, T'y is off by sqrt(3) off
/// of now. What a ball is off by because bodies do not stand where their orthonormal poses have
/// them, and what those turn differently by, is in the noise of both poses, thrice, which is less
/// than off: 8 off of then and of now pay for all. Differences, squares and the root are off by
/// fewer than 16 e of themselves; squares that underflow by less than 2^-60 after the root, which
/// is added as 2^-120 under it, and stands for a radius that underflowed, too. Turns are summed up
/// in double and rounded to float: 2e of each. What is no number counts as no distance.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "traversal/front.hpp"
#include "traversal/wide/frames.hpp"

namespace bvlab {

class WideFront {
 public:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  static constexpr int width = std::clamp(native_width<float>, 4, 16);
  using S = Batch<float, width>;

  struct Entry {
    NodePair pair;          ///< of nodes; or a triangle of a with a leaf of b
    std::uint16_t opened;   ///< lanes
    std::uint8_t triangle;  ///< 0 or 1
    std::uint8_t rest;      ///< how many times its gap is not to be measured
  };

  std::size_t size() const { return entries_.size(); }
  bool is_complete() const { return complete_at_ > 0; }
  void clear() { entries_.clear(), measured_.clear(), complete_at_ = 0; }
  void complete() { complete_at_ = entries_.size(); }
  /// So much longer than when it was complete that it is to be made anew.
  bool overgrown() const { return entries_.size() > 2 * complete_at_ + 16; }

  Entry& operator[](std::size_t i) { return entries_[i]; }
  /// What it is of may touch; says at which place it is.
  std::size_t add(const Entry& entry) {
    const std::size_t i = entries_.size();
    if (i % width == 0) measured_.emplace_back();
    entries_.push_back(entry);
    touches(i);
    return i;
  }
  void touches(std::size_t i) { measured_[i / width].gap[i % width] = 0; }
  /// What it is of is so far apart, where that ball is; both bodies have turned by so much.
  void is_apart(std::size_t i, float gap, const Place& place, double turn) {
    Measured& to = measured_[i / width];
    const std::size_t lane = i % width;
    for (std::size_t k = 0; k < 3; ++k) {
      to.of_a[k][lane] = place.of_a[k];
      to.of_b[k][lane] = place.of_b[k];
    }
    to.radius[lane] = place.radius;
    to.turn[lane] = static_cast<float>(turn) * (1 - 2 * unit_roundoff<float>);
    to.gap[lane] = gap - 8 * place.off;
  }

  /// How far apart entries `first` and up, a multiple of `width`, still are at least; not positive
  /// where that is not known.
  [[gnu::always_inline]] S left(std::size_t first, const CornersBetween& corners,
                                double turn) const {
    using stdx::min, stdx::sqrt;
    constexpr float e = unit_roundoff<float>;
    const Measured& from = measured_[first / width];
    const auto lanes = [](const Lanes& x) { return S(x.data(), stdx::vector_aligned); };
    const auto now =
        corners.turned<S>(lanes(from.of_a[0]), lanes(from.of_a[1]), lanes(from.of_a[2]));
    S squared(0x1p-120f);
    for (std::size_t k = 0; k < 3; ++k) {
      const S moved = now[k] - lanes(from.of_b[k]);
      squared = fused<S>(moved, moved, squared);
    }
    const S turned =
        min(S(static_cast<float>(turn) * (1 + 2 * e)) - lanes(from.turn), S(2.0f + 16 * e));
    const S nearer = sqrt(squared) * S(1 + 16 * e) + turned * lanes(from.radius) * S(1 + 4 * e);
    return (lanes(from.gap) - nearer) - S(8 * corners.off());
  }

 private:
  using Lanes = std::array<float, width>;
  /// Of `width` entries.
  struct alignas(sizeof(float) * width) Measured {
    std::array<Lanes, 3> of_a{}, of_b{};
    Lanes radius{}, turn{}, gap{};
  };

  std::vector<Entry> entries_;
  std::vector<Measured> measured_;
  std::size_t complete_at_ = 0;
};

}  // namespace bvlab
