// SPDX-License-Identifier: BSD-3-Clause
/// A std::vector for large arrays that are written before they are read: growing does not
/// initialise elements without a constructor, so that no page is touched twice. Arrays of two
/// megabytes and more are allocated in whole huge pages. Where few parts of an array will be
/// written, its pages can be left to be brought in when they are: those that are not cost nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "hierarchies/geometry/pages.hpp"

namespace bvlab {

enum class Paging : std::uint8_t { at_once, when_written };

template <class T>
class LargeAllocator : public std::allocator<T> {
 public:
  template <class U>
  struct rebind {
    using other = LargeAllocator<U>;
  };

  LargeAllocator() = default;
  explicit LargeAllocator(Paging paging) : paging_(paging) {}
  template <class U>
  LargeAllocator(const LargeAllocator<U>& other) : paging_(other.paging()) {}
  Paging paging() const { return paging_; }

  T* allocate(std::size_t count) {
    constexpr std::size_t worth_asking = std::size_t{1} << 16;
    const std::size_t bytes = count * sizeof(T);
    if (bytes < worth_asking || count > static_cast<std::size_t>(-1) / 2 / sizeof(T))
      return std::allocator<T>::allocate(count);
    if (bytes < pages::huge) {
      T* const memory = std::allocator<T>::allocate(count);
      if (paging_ == Paging::at_once) pages::bring(memory, memory + count);
      return memory;
    }
    const std::size_t whole = (bytes + pages::huge - 1) / pages::huge * pages::huge;
    const auto memory =
        static_cast<std::byte*>(::operator new(whole, std::align_val_t(pages::huge)));
    pages::advise(memory, memory + whole, paging_ == Paging::at_once);
    for (std::size_t k = 0; paging_ == Paging::at_once && k < whole; k += pages::huge)
      if (!pages::bring(memory + k, memory + k + pages::huge)) {
        // The rest in small pages, but in bulk all the same.
        pages::advise(memory, memory + whole, false);
        pages::bring(memory + k + pages::huge, memory + whole);
        break;
      }
    return reinterpret_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < pages::huge)
      std::allocator<T>::deallocate(memory, count);
    else
      ::operator delete(memory, std::align_val_t(pages::huge));
  }

  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    if constexpr (sizeof...(Values) == 0)
      ::new (static_cast<void*>(at)) U;
    else
      ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }

 private:
  Paging paging_ = Paging::at_once;
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace bvlab
