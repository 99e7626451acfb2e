// SPDX-License-Identifier: BSD-3-Clause
/// Sorting by integer keys in three passes of eleven bits, O(n), stable; a pass in which all keys
/// agree is skipped. Floating-point numbers sort as the integers that `sort_key` makes of them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace bvlab {

/// Orders as `x` does: the bits of a positive number grow with it, those of a negative one shrink.
/// Minus zero counts as zero.
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

/// O(n + swaps), stable: for few items, and for many that are nearly sorted.
template <class Key>
void insertion_sort(std::span<Keyed<Key>> items) {
  for (std::size_t k = 1; k < items.size(); ++k) {
    const Keyed<Key> item = items[k];
    std::size_t hole = k;
    for (; hole > 0 && items[hole - 1].key > item.key; --hole) items[hole] = items[hole - 1];
    items[hole] = item;
  }
}

/// Sorts `items` by key, using `spare` for room.
template <class Key>
void radix_sort(std::vector<Keyed<Key>>& items, std::vector<Keyed<Key>>& spare) {
  if (items.size() < 64) return insertion_sort(std::span(items));
  constexpr int digit = 11, passes = (8 * sizeof(Key) + digit - 1) / digit;
  constexpr Key low = (Key{1} << digit) - 1;
  std::array<std::array<std::uint32_t, 1 << digit>, passes> counts{};
  for (const auto& item : items)
    for (int pass = 0; pass < passes; ++pass) ++counts[pass][(item.key >> (digit * pass)) & low];
  spare.resize(items.size());
  for (int pass = 0; pass < passes; ++pass) {
    const int shift = digit * pass;
    auto& count = counts[pass];
    if (count[(items[0].key >> shift) & low] == items.size()) continue;
    std::uint32_t sum = 0;
    for (auto& c : count) sum += std::exchange(c, sum);
    const Keyed<Key>* from = items.data();
    Keyed<Key>* to = spare.data();
    for (std::size_t k = 0; k < items.size(); ++k)
      to[count[(from[k].key >> shift) & low]++] = from[k];
    std::swap(items, spare);
  }
}

}  // namespace bvlab
