// SPDX-License-Identifier: BSD-3-Clause
/// What this process holds of memory.
#pragma once

#include <malloc.h>
#include <sys/resource.h>

#include <cstddef>
#include <cstdint>

namespace bvlab {

/// Resident bytes at their peak; the system counts in KiB.
inline std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// Bytes of the heap now, all threads' allocations together.
inline std::size_t heap_bytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// Gives what was freed back to the system, as far as that can be: who allocates next gets pages
/// that were not touched before.
inline void give_back_heap() { malloc_trim(0); }

}  // namespace bvlab
