// SPDX-License-Identifier: BSD-3-Clause
/// Gathers W volumes from anywhere in an array into one volume over batches (transpose.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "hierarchies/bounding_volume.hpp"
#include "traversal/transpose.hpp"

namespace bvlab {

/// Lane i of the result is `base[indices[i]]`. V must be a plain aggregate of its scalars.
template <Batched B, class V>
[[gnu::always_inline]] inline Over<V, B> gather(const V* base, const std::uint32_t* indices) {
  using T = typename V::scalar;
  constexpr int fields = sizeof(V) / sizeof(T), lanes = width<B>();
  static_assert(std::is_standard_layout_v<V> && sizeof(V) % sizeof(T) == 0);
  static_assert(sizeof(Over<V, B>) == sizeof(B) * fields && sizeof(B) == sizeof(T) * lanes);
  Over<V, B> result;
  [[maybe_unused]] T* const out = reinterpret_cast<T*>(&result);
  if constexpr (std::is_same_v<T, float> && lanes >= 4 && fields >= 4) {
    // The last group overlaps the one before where the fields are no multiple of four.
    for (int field = 0; field < fields; field += 4) {
      const int from = std::min(field, fields - 4);
      const auto columns = detail::columns_of<float, lanes>(
          [&](int i) { return reinterpret_cast<const float*>(base + indices[i]) + from; });
      std::memcpy(out + from * lanes, &columns, sizeof columns);
    }
  } else {
    // Filled in an array and copied: a batch may not be written through a T*.
    for (int field = 0; field < fields; ++field) {
      T column[lanes];
      for (int i = 0; i < lanes; ++i)
        column[i] = reinterpret_cast<const T*>(base + indices[i])[field];
      std::memcpy(reinterpret_cast<char*>(&result) + sizeof column * field, column, sizeof column);
    }
  }
  return result;
}

}  // namespace bvlab
