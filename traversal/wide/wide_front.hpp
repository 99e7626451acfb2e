// SPDX-License-Identifier: BSD-3-Clause
/// The front of two wide trees. Its entries: every step of the traversal, with the lanes it opened,
/// the least gap of the others and the sphere at which it was measured; and every pair whose
/// triangles were tested, likewise once its gap has been measured. Such a pair is a triangle and a
/// leaf (kernel siblings) or two leaves (kernel mixed).
///
/// Law: every pair of triangles lies below an unopened lane of exactly one entry, or in one entry
/// of triangles.
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
/// what both bodies have rotated by since, and 2.
///
/// Rounding, with e = 2^-24. Let d be the error bound of any coordinate of T'y (CornerTransform),
/// and d_0 that of Ty, when the gap was measured. y and Ty, as they are kept, correspond to each
/// other to within sqrt(3) d_0; T'y has an error below sqrt(3) d. Bodies' poses are not quite their
/// orthonormal poses: what that adds to a sphere, and to the difference of the rotations, is at
/// most thrice the error bound of both poses, which is less than d. 8 d_0 + 8 d cover all.
/// Differences, squares and the root are off by fewer than 16 e of themselves; squares that
/// underflow by less than 2^-60 after the root, which is added as 2^-120 under it, and covers a
/// radius that underflowed, too. Rotations are summed up in double and rounded to float: 2e of
/// each. NaN counts as no gap.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "traversal/node_pair.hpp"
#include "traversal/wide/relative_frame.hpp"

namespace bvlab {

class WideFront {
 public:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  static constexpr int width = std::clamp(native_width<float>, 4, 16);
  using S = Batch<float, width>;

  struct Entry {
    NodePair pair;          ///< of a step, or of tested triangles
    std::uint16_t opened;   ///< the opened lanes of a step
    std::uint8_t triangle;  ///< 1 for a pair of tested triangles
    std::uint8_t rest;      ///< tests to come in which its gap is not measured
  };

  std::size_t size() const { return entries_.size(); }
  bool is_complete() const { return complete_at_ > 0; }
  void clear() { entries_.clear(), measured_.clear(), complete_at_ = 0; }
  void complete() { complete_at_ = entries_.size(); }
  /// Whether the front is so much longer than when it was complete that it should be rebuilt.
  bool overgrown() const { return entries_.size() > 2 * complete_at_ + 16; }

  Entry& operator[](std::size_t i) { return entries_[i]; }
  /// Adds an entry whose gap is not known; returns its index.
  std::size_t add(const Entry& entry) {
    const std::size_t i = entries_.size();
    if (i % width == 0) measured_.emplace_back();
    entries_.push_back(entry);
    return i;
  }
  /// Sets the gap of an entry, the sphere at which it was measured, and the rotation of both bodies
  /// since the first frame.
  void set_gap(std::size_t i, float gap, const ReferenceSphere& reference, double rotation) {
    Measured& to = measured_[i / width];
    const std::size_t lane = i % width;
    for (std::size_t k = 0; k < 3; ++k) {
      to.of_a[k][lane] = reference.centre_in_a[k];
      to.of_b[k][lane] = reference.centre_in_b[k];
    }
    to.radius[lane] = reference.radius;
    to.rotation[lane] = static_cast<float>(rotation) * (1 - 2 * unit_roundoff<float>);
    to.gap[lane] = gap - 8 * reference.error_bound;
  }

  /// Lower bounds on what is left of the gaps of entries `first` and up, `first` a multiple of
  /// `width`; not positive where no gap is known.
  [[gnu::always_inline]] S remaining_gaps(std::size_t first, const CornerTransform& a_to_b,
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
  using Lanes = std::array<float, width>;
  /// The measured gaps of `width` entries.
  struct alignas(sizeof(float) * width) Measured {
    std::array<Lanes, 3> of_a{}, of_b{};
    Lanes radius{}, rotation{}, gap{};  // the gap is 0 until it is measured
  };

  std::vector<Entry> entries_;
  std::vector<Measured> measured_;
  std::size_t complete_at_ = 0;
};

/// Pauses of the front: traversals without one after a front that wore out.
class FrontPause {
 public:
  /// Counts one traversal; returns whether it may keep a front.
  bool over() { return remaining_ == 0 || (--remaining_, false); }
  /// Called when a front was retested: one that wore out starts a pause, longer each time.
  void begin(bool worn) {
    if (worn) remaining_ = next_;
    next_ = worn ? std::min(4 * next_, longest) : shortest;
  }

 private:
  static constexpr int shortest = 16, longest = 256;
  int remaining_ = 0, next_ = shortest;
};

}  // namespace bvlab
