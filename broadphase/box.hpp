// SPDX-License-Identifier: BSD-3-Clause
/// Axis-aligned boxes, pairs of boxes, and the two senses in which boxes overlap.
///
/// A frame is a span of boxes laid out as in a box trace: `lo x y z, hi x y z`, box after box.
/// Methods copy the boxes into arrays of their own, in an order of their own; they read a frame
/// during a call and never keep a reference to it.
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

/// Half-open boxes [lo, hi): touching does not count. Two boxes overlap where, on every axis, each
/// starts before the other ends. So a box of zero extent overlaps every box in whose interior it
/// lies, but not itself.
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

/// A box that breaks the precondition of every method: its index and what is wrong.
struct BoxFault {
  std::size_t box;
  std::string_view what;
};

/// The first box with a NaN, an infinity or lo > hi; nothing where every box is valid.
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
