// SPDX-License-Identifier: BSD-3-Clause
/// Asks the system for memory pages before they are first written. Populating them in bulk takes
/// two thirds of the time of page faults one by one, and huge pages take a third (a fortieth, on a
/// virtual machine whose host has backed the memory). Only time depends on this; on systems other
/// than Linux nothing is done.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#include <time.h>
#endif

namespace bvlab::pages {

inline constexpr std::size_t small = 4096, huge = std::size_t{1} << 21;

/// Sets whether the memory from `begin` to `end`, which must hold nothing else, uses huge pages.
inline void advise([[maybe_unused]] void* begin, [[maybe_unused]] void* end,
                   [[maybe_unused]] bool in_huge_pages) {
#if defined(__linux__) && defined(MADV_HUGEPAGE) && defined(MADV_NOHUGEPAGE)
  const auto first = reinterpret_cast<std::uintptr_t>(begin) / small * small;
  const auto last = (reinterpret_cast<std::uintptr_t>(end) + small - 1) / small * small;
  madvise(reinterpret_cast<void*>(first), last - first,
          in_huge_pages ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
#endif
}

/// Has the system populate the pages from `begin` to `end` now. False where huge pages took about
/// twice as long as small ones (1 ms each): on a virtual machine the host may not have backed the
/// memory yet, or the system had to make room.
inline bool bring([[maybe_unused]] void* begin, [[maybe_unused]] void* end) {
#if defined(__linux__) && defined(MADV_POPULATE_WRITE)
  const auto first = (reinterpret_cast<std::uintptr_t>(begin) + small - 1) / small * small;
  const auto last = reinterpret_cast<std::uintptr_t>(end) / small * small;
  if (first >= last) return true;
  const auto worked = [] {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
  };
  const double start = worked();
  madvise(reinterpret_cast<void*>(first), last - first, MADV_POPULATE_WRITE);
  constexpr double microseconds = 1000;
  return worked() - start < microseconds * (1 + static_cast<double>((last - first) / huge));
#else
  return true;
#endif
}

}  // namespace bvlab::pages
