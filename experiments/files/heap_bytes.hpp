// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <malloc.h>

#include <cstddef>

namespace bvlab {

/// What the program holds of the heap now, all threads' allocations together.
inline std::size_t heap_bytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// What was freed goes back to the system, as far as it can: who allocates next gets pages that
/// were not touched before.
inline void give_back_heap() { malloc_trim(0); }

}  // namespace bvlab
