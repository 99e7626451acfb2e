// SPDX-License-Identifier: BSD-3-Clause
/// Radix sort by integer keys in passes of at most eleven bits: O(n), stable. On one thread, a
/// pass in which all keys agree is skipped. Floating-point numbers are sorted by their `sort_key`.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

/// An integer key in the order of `x`, which must not be NaN: the bits of a positive number grow
/// with it, those of a negative one shrink. Minus zero equals zero.
template <class T>
auto sort_key(T x) {
  using Key = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  constexpr Key top = Key{1} << (8 * sizeof(Key) - 1);
  const Key bits = std::bit_cast<Key>(x + T(0));
  return bits & top ? static_cast<Key>(~bits) : static_cast<Key>(bits | top);
}

template <class Key>
struct Keyed {
  Key key;
  std::uint32_t id;
};

/// O(n + swaps), stable: for few items, or for many that are nearly sorted.
template <class Key>
void insertion_sort(std::span<Keyed<Key>> items) {
  for (std::size_t k = 1; k < items.size(); ++k) {
    const Keyed<Key> item = items[k];
    std::size_t hole = k;
    for (; hole > 0 && items[hole - 1].key > item.key; --hole) items[hole] = items[hole - 1];
    items[hole] = item;
  }
}

/// Sorts `items` by the lowest `bits` of their keys (all higher bits must be 0), with `spare` as a
/// buffer.
template <class Key, class Allocator>
void radix_sort(std::vector<Keyed<Key>, Allocator>& items,
                std::vector<Keyed<Key>, Allocator>& spare, int bits = 8 * sizeof(Key)) {
  if (items.size() < 64) return insertion_sort(std::span(items));
  constexpr int widest = 11, most_passes = (8 * sizeof(Key) + widest - 1) / widest;
  const int passes = (bits + widest - 1) / widest, digit = (bits + passes - 1) / passes;
  const Key low = (Key{1} << digit) - 1;
  std::array<std::array<std::uint32_t, 1 << widest>, most_passes> counts;
  for (int pass = 0; pass < passes; ++pass) std::fill_n(counts[pass].begin(), low + 1, 0u);
  for (const auto& item : items)
    for (int pass = 0; pass < passes; ++pass) ++counts[pass][(item.key >> (digit * pass)) & low];
  spare.resize(items.size());
  for (int pass = 0; pass < passes; ++pass) {
    const int shift = digit * pass;
    auto& count = counts[pass];
    if (count[(items[0].key >> shift) & low] == items.size()) continue;
    std::uint32_t sum = 0;
    for (std::size_t value = 0; value <= low; ++value) sum += std::exchange(count[value], sum);
    const Keyed<Key>* from = items.data();
    Keyed<Key>* to = spare.data();
    for (std::size_t k = 0; k < items.size(); ++k)
      to[count[(from[k].key >> shift) & low]++] = from[k];
    std::swap(items, spare);
  }
}

/// The same result by several threads where there are many items: each counts and moves a part of
/// them.
template <class Key, class Allocator>
void radix_sort(std::vector<Keyed<Key>, Allocator>& items,
                std::vector<Keyed<Key>, Allocator>& spare, int bits, Threads& threads) {
  const std::size_t parts = threads.count();
  if (parts == 1 || items.size() < (1u << 15)) return radix_sort(items, spare, bits);
  constexpr int widest = 11;
  const int passes = (bits + widest - 1) / widest, digit = (bits + passes - 1) / passes;
  const Key low = (Key{1} << digit) - 1;
  using Counts = std::array<std::uint32_t, 1 << widest>;
  std::vector<Counts> counts(parts);  // of each part of the items
  spare.resize(items.size());
  const auto first = [&](std::size_t part) { return items.size() * part / parts; };
  for (int pass = 0; pass < passes; ++pass) {
    const int shift = digit * pass;
    threads.share(parts, [&](std::size_t part, std::size_t) {
      Counts& count = counts[part];
      std::fill_n(count.begin(), low + 1, 0u);
      for (std::size_t k = first(part); k < first(part + 1); ++k)
        ++count[(items[k].key >> shift) & low];
    });
    std::uint32_t sum = 0;
    for (std::size_t value = 0; value <= low; ++value)
      for (Counts& count : counts) sum += std::exchange(count[value], sum);
    threads.share(parts, [&](std::size_t part, std::size_t) {
      Counts& count = counts[part];
      const Keyed<Key>* from = items.data();
      Keyed<Key>* to = spare.data();
      for (std::size_t k = first(part); k < first(part + 1); ++k)
        to[count[(from[k].key >> shift) & low]++] = from[k];
    });
    std::swap(items, spare);
  }
}

}  // namespace bvlab
