// SPDX-License-Identifier: BSD-3-Clause
/// Boxes, pairs of them, and what it means that two overlap.
///
/// A frame is a span of boxes as a box trace holds them: `lo x y z, hi x y z`, one after the other.
/// Methods copy them into arrays of their own, in their own order, so a frame is read and never
/// kept.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace bvlab {

/// The points p with lo <= p <= hi, axis by axis; lo == hi is legal.
template <class T>
struct Box {
  T lo[3];
  T hi[3];

  friend bool operator==(const Box&, const Box&) = default;
};

template <class T>
using Boxes = std::span<const Box<T>>;

/// Two boxes by their indices in the frame, i < j.
struct Pair {
  std::uint32_t i;
  std::uint32_t j;

  friend auto operator<=>(const Pair&, const Pair&) = default;
};
static_assert(sizeof(Pair) == 8);

inline Pair ordered(std::uint32_t a, std::uint32_t b) { return a < b ? Pair{a, b} : Pair{b, a}; }

/// Touching counts as overlapping.
struct Closed {
  static constexpr std::string_view name = "closed";
  /// Whether an interval that ends at `hi` reaches one that starts at `lo`.
  template <class S>
  static auto reaches(const S& hi, const S& lo) {
    return hi >= lo;
  }
};

/// Boxes without their upper faces: touching does not count. Two boxes overlap where, on every
/// axis, each starts before the other ends; so a box of zero extent overlaps what it lies strictly
/// inside of, and not itself.
struct HalfOpen {
  static constexpr std::string_view name = "half-open";
  template <class S>
  static auto reaches(const S& hi, const S& lo) {
    return hi > lo;
  }
};

template <class Contact, class T>
bool overlap(const Box<T>& a, const Box<T>& b) {
  return Contact::reaches(a.hi[0], b.lo[0]) & Contact::reaches(b.hi[0], a.lo[0]) &
         Contact::reaches(a.hi[1], b.lo[1]) & Contact::reaches(b.hi[1], a.lo[1]) &
         Contact::reaches(a.hi[2], b.lo[2]) & Contact::reaches(b.hi[2], a.lo[2]);
}

/// Where a frame breaks what every method relies on.
struct BoxFault {
  std::size_t box;
  std::string_view what;
};

/// The first box that is not finite or not ordered, if there is one.
template <class T>
std::optional<BoxFault> first_fault(Boxes<T> boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const T lo = boxes[i].lo[axis], hi = boxes[i].hi[axis];
      if (std::isnan(lo) || std::isnan(hi)) return BoxFault{i, "NaN"};
      if (std::isinf(lo) || std::isinf(hi)) return BoxFault{i, "infinity"};
      if (lo > hi) return BoxFault{i, "lo > hi"};
    }
  return std::nullopt;
}

}  // namespace bvlab
