// SPDX-License-Identifier: BSD-3-Clause
/// A std::vector for large arrays that are written before they are read: what has no constructor is
/// left as it is when the vector grows, so that no page is touched twice, and memory of megabytes
/// is asked for in huge pages, of which a page fault brings five hundred times as much.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace bvlab {

inline constexpr std::size_t huge_page = std::size_t{1} << 21;

/// Where there is as much as that, it begins with a huge page.
template <class T>
class LargeAllocator {
 public:
  using value_type = T;

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T) - huge_page)
      throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T);
    if (bytes < huge_page) return std::allocator<T>().allocate(count);
    void* const memory = std::aligned_alloc(huge_page, (bytes + huge_page - 1) & ~(huge_page - 1));
    if (!memory) throw std::bad_alloc();
#if defined(__linux__)
    // Of whole pages alone: the rest may never be needed. A refusal costs time and nothing else.
    madvise(memory, bytes & ~(huge_page - 1), MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < huge_page) return std::allocator<T>().deallocate(memory, count);
    std::free(memory);
  }

  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    if constexpr (sizeof...(Values) == 0)
      ::new (static_cast<void*>(at)) U;
    else
      ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }

  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace bvlab
