// SPDX-License-Identifier: BSD-3-Clause
/// A std::vector for large arrays that are written before they are read: what has no constructor is
/// left as it is when the vector grows, so that no page is touched twice.
///
/// Tried and not kept: to ask for huge pages. Where memory is in large pieces the first call of
/// `blocks` took 0.65 of the time, where it is not the system tidied up first, and it took 2 to 4
/// times as long.
#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace bvlab {

template <class T>
class LargeAllocator : public std::allocator<T> {
 public:
  template <class U>
  struct rebind {
    using other = LargeAllocator<U>;
  };

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}

  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    if constexpr (sizeof...(Values) == 0)
      ::new (static_cast<void*>(at)) U;
    else
      ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace bvlab
