// SPDX-License-Identifier: BSD-3-Clause
/// A number as files have it in bytes, lowest byte first. As a double it is exact up to 2^53.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

namespace bvlab {

static_assert(std::endian::native == std::endian::little);

struct NumberType {
  std::size_t size;
  double (*read)(const char* bytes);
  double largest;
  bool is_whole, is_signed;

  friend bool operator==(const NumberType& a, const NumberType& b) { return a.read == b.read; }
};

template <class T>
inline constexpr NumberType number_type{sizeof(T),
                                        [](const char* bytes) {
                                          T value;
                                          std::memcpy(&value, bytes, sizeof value);
                                          return static_cast<double>(value);
                                        },
                                        static_cast<double>(std::numeric_limits<T>::max()),
                                        std::is_integral_v<T>, std::is_signed_v<T>};

}  // namespace bvlab
