// SPDX-License-Identifier: BSD-3-Clause
/// Replaces the allocation functions of a test program: each allocation calls `before_allocation`
/// first, which may throw std::bad_alloc. To be included by one file of the program.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace bvlab {

/// Called on any thread.
inline void (*before_allocation)() = [] {};

namespace detail {
inline void* allocated(std::size_t bytes, std::size_t alignment) {
  before_allocation();
  bytes = bytes ? bytes : 1;
  void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
  return memory;
}
}  // namespace detail

}  // namespace bvlab

// Replacements may not be inline.
// NOLINTBEGIN(misc-definitions-in-headers)
void* operator new(std::size_t bytes) {
  return bvlab::detail::allocated(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return bvlab::detail::allocated(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
// NOLINTEND(misc-definitions-in-headers)
