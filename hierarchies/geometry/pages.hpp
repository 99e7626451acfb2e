// SPDX-License-Identifier: BSD-3-Clause
/// Memory that is about to be written for the first time, asked of the system beforehand: its pages
/// cost two thirds of what they cost one by one, as they are touched, and huge pages a third.
/// Nothing but time depends on any of it, and elsewhere than on Linux nothing is done.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#include <time.h>
#endif

namespace bvlab::pages {

inline constexpr std::size_t small = 4096, huge = std::size_t{1} << 21;
/// Where a single huge page that comes slowly (`bring`) does not cost more than all others save.
inline constexpr std::size_t worth_huge = 8 * huge;

/// Whether the memory from `begin` to `end`, which is nobody else's, shall come in huge pages.
inline void advise([[maybe_unused]] void* begin, [[maybe_unused]] void* end,
                   [[maybe_unused]] bool in_huge_pages) {
#if defined(__linux__) && defined(MADV_HUGEPAGE) && defined(MADV_NOHUGEPAGE)
  const auto first = reinterpret_cast<std::uintptr_t>(begin) / small * small;
  const auto last = (reinterpret_cast<std::uintptr_t>(end) + small - 1) / small * small;
  madvise(reinterpret_cast<void*>(first), last - first,
          in_huge_pages ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
#endif
}

/// Has the system provide what lies from `begin` to `end` now. False where a huge page took as long
/// as two times its small ones: on a virtual machine, the host may not have touched large pieces of
/// memory yet, or the system may have had to make room.
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
