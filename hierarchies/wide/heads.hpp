// SPDX-License-Identifier: BSD-3-Clause
/// An array of objects of a type derived from T, seen as objects of T.
#pragma once

#include <cstddef>

namespace bvlab {

template <class T>
class Heads {
 public:
  Heads() = default;
  /// The array begins at `first` and must outlive this.
  template <class Derived>
  explicit Heads(const Derived* first)
      : at_(reinterpret_cast<const std::byte*>(static_cast<const T*>(first))),
        bytes_(sizeof(Derived)) {}

  const T& operator[](std::size_t i) const { return *reinterpret_cast<const T*>(at_ + i * bytes_); }

 private:
  const std::byte* at_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace bvlab
