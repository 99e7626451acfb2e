// SPDX-License-Identifier: BSD-3-Clause
/// A box as two vectors of four, for the comparison of two given boxes in a few instructions that
/// every x86-64 has.
///
/// x <= y where the sign bit of y - x is clear: an IEEE difference has the sign of the exact one,
/// equal numbers differ by +0, and rows hold no -0. So six comparisons are two vector subtractions
/// and one test of sign bits.
#pragma once

#include <cstdint>
#include <cstring>

#include "broadphase/structures/block.hpp"

namespace bvlab {

/// Three axes; the fourth lane is zero.
template <class T>
struct Row {
  Four<T> lo, hi;
};

namespace detail {
template <class T>
using Bits = std::conditional_t<sizeof(T) == 4, Four<std::int32_t>, Four<std::int64_t>>;
/// The lanes in which the sign bit of `a` or of `b` is set.
template <class T>
inline int either_sign(const Four<T>& a, const Four<T>& b) {
  return signs(
      reinterpret_cast<Four<T>>(reinterpret_cast<Bits<T>>(a) | reinterpret_cast<Bits<T>>(b)));
}
template <class T>
inline int both_signs(const Four<T>& a, const Four<T>& b) {
  return signs(
      reinterpret_cast<Four<T>>(reinterpret_cast<Bits<T>>(a) & reinterpret_cast<Bits<T>>(b)));
}
}  // namespace detail

template <class T>
inline Row<T> row_of(const Box<T>& box) {
  Four<T> lower, upper;  // the box is six numbers: its first four, and its last four
  std::memcpy(&lower, box.lo, sizeof lower);
  std::memcpy(&upper, box.lo + 2, sizeof upper);
  const Four<T> zero{};
  return {__builtin_shufflevector(lower, zero, 0, 1, 2, 4) + zero,
          __builtin_shufflevector(upper, zero, 1, 2, 3, 4) + zero};
}
static_assert(sizeof(Box<float>) == 6 * sizeof(float));

template <class T>
inline Box<T> box_of(const Row<T>& row) {
  return {{row.lo[0], row.lo[1], row.lo[2]}, {row.hi[0], row.hi[1], row.hi[2]}};
}

/// The sentinel that overlaps nothing.
template <class T>
inline Row<T> nowhere_row() {
  return row_of(nowhere<T>());
}

template <class Contact, class T>
inline bool overlap(const Row<T>& a, const Row<T>& b) {
  if constexpr (std::is_same_v<Contact, Closed>)
    return detail::either_sign<T>(b.hi - a.lo, a.hi - b.lo) == 0;
  else
    return (detail::both_signs<T>(a.lo - b.hi, b.lo - a.hi) & 7) == 7;
}

/// Whether every point of `a` is in `b`.
template <class T>
inline bool inside(const Row<T>& a, const Row<T>& b) {
  return detail::either_sign<T>(a.lo - b.lo, b.hi - a.hi) == 0;
}

template <class T>
inline bool same(const Row<T>& a, const Row<T>& b) {
  const auto differ =
      (reinterpret_cast<detail::Bits<T>>(a.lo) ^ reinterpret_cast<detail::Bits<T>>(b.lo)) |
      (reinterpret_cast<detail::Bits<T>>(a.hi) ^ reinterpret_cast<detail::Bits<T>>(b.hi));
  std::uint64_t word[sizeof differ / 8], any = 0;
  std::memcpy(word, &differ, sizeof differ);
  for (const std::uint64_t w : word) any |= w;
  return any == 0;
}

template <class T>
inline Four<T> absolute(const Four<T>& a) {
  return a < 0 ? -a : a;
}
template <class T>
inline Four<T> least(const Four<T>& a, const Four<T>& b) {
  return a < b ? a : b;
}
template <class T>
inline Four<T> most(const Four<T>& a, const Four<T>& b) {
  return a > b ? a : b;
}

/// The largest absolute change of a coordinate.
template <class T>
inline T largest_change(const Row<T>& a, const Row<T>& b) {
  const Four<T> change = most<T>(absolute<T>(a.lo - b.lo), absolute<T>(a.hi - b.hi));
  return std::max({change[0], change[1], change[2]});
}

}  // namespace bvlab
