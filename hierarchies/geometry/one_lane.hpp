// SPDX-License-Identifier: BSD-3-Clause
/// Batches without vector registers: lanes are computed one after the other. Replaces
/// std::experimental::simd where BVLAB_ONE_LANE is defined, so that a measurement can tell the
/// effect of the algorithm from that of SIMD; it has only the members that the engine uses. Compile
/// with -fno-tree-vectorize -fno-tree-slp-vectorize, or the compiler vectorises it again.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace bvlab::one_lane {

struct element_aligned_tag {};
struct vector_aligned_tag {};
inline constexpr element_aligned_tag element_aligned{};
inline constexpr vector_aligned_tag vector_aligned{};

template <class Tag>
concept Alignment =
    std::is_same_v<Tag, element_aligned_tag> || std::is_same_v<Tag, vector_aligned_tag>;

namespace simd_abi {
template <int W>
struct lanes {
  static constexpr int width = W;
};
template <class, int W>
using deduce_t = lanes<W>;
}  // namespace simd_abi

/// Calls f(0), f(1), ... f(W - 1), each index a constant.
template <int W, class F>
[[gnu::always_inline]] constexpr void each_lane(F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, i>()), ...);
  }
  (std::make_integer_sequence<int, W>());
}

template <class T, class Abi>
class simd_mask {
 public:
  static constexpr int W = Abi::width;
  simd_mask() = default;
  [[gnu::always_inline]] explicit simd_mask(bool all) {
    each_lane<W>([&](auto i) __attribute__((always_inline)) { lane_[i] = all; });
  }
  static constexpr std::size_t size() { return W; }

  [[gnu::always_inline]] bool operator[](std::size_t i) const { return lane_[i]; }
  [[gnu::always_inline]] bool& operator[](std::size_t i) { return lane_[i]; }
  /// Bit i is set where lane i is true.
  [[gnu::always_inline]] std::uint64_t bits() const {
    std::uint64_t result = 0;
    each_lane<W>([&](auto i) __attribute__((always_inline)) {
      result |= static_cast<std::uint64_t>(lane_[i]) << i;
    });
    return result;
  }

  [[gnu::always_inline]] friend simd_mask operator&&(const simd_mask& a, const simd_mask& b) {
    return of([&](auto i) __attribute__((always_inline)) {
      return static_cast<bool>(int{a.lane_[i]} & int{b.lane_[i]});
    });
  }
  [[gnu::always_inline]] friend simd_mask operator||(const simd_mask& a, const simd_mask& b) {
    return of([&](auto i) __attribute__((always_inline)) {
      return static_cast<bool>(int{a.lane_[i]} | int{b.lane_[i]});
    });
  }
  [[gnu::always_inline]] friend simd_mask operator&(const simd_mask& a, const simd_mask& b) {
    return a && b;
  }
  [[gnu::always_inline]] friend simd_mask operator|(const simd_mask& a, const simd_mask& b) {
    return a || b;
  }
  [[gnu::always_inline]] friend simd_mask operator^(const simd_mask& a, const simd_mask& b) {
    return a != b;
  }
  [[gnu::always_inline]] friend simd_mask operator!=(const simd_mask& a, const simd_mask& b) {
    return of([&](auto i) __attribute__((always_inline)) { return a.lane_[i] != b.lane_[i]; });
  }
  [[gnu::always_inline]] friend simd_mask operator==(const simd_mask& a, const simd_mask& b) {
    return of([&](auto i) __attribute__((always_inline)) { return a.lane_[i] == b.lane_[i]; });
  }
  [[gnu::always_inline]] simd_mask operator!() const {
    return of([&](auto i) __attribute__((always_inline)) { return !lane_[i]; });
  }
  [[gnu::always_inline]] simd_mask& operator&=(const simd_mask& b) { return *this = *this && b; }
  [[gnu::always_inline]] simd_mask& operator|=(const simd_mask& b) { return *this = *this || b; }

  template <class F>
  [[gnu::always_inline]] static simd_mask of(F&& f) {
    simd_mask mask;
    each_lane<W>([&](auto i) __attribute__((always_inline)) { mask.lane_[i] = f(i); });
    return mask;
  }

 private:
  std::array<bool, W> lane_;
};

template <class T, class Abi = simd_abi::lanes<1>>
class alignas(sizeof(T) * Abi::width) simd {
 public:
  static constexpr int W = Abi::width;
  using value_type = T;
  using mask_type = simd_mask<T, Abi>;

  simd() = default;
  template <class N>
    requires std::is_arithmetic_v<N>
  [[gnu::always_inline]] simd(N all) {
    each_lane<W>([&](auto i) __attribute__((always_inline)) { lane_[i] = static_cast<T>(all); });
  }
  template <class F>
    requires requires(F f) { f(std::integral_constant<std::size_t, 0>()); }
  [[gnu::always_inline]] explicit simd(F&& f) {
    each_lane<W>([&](auto i) __attribute__((always_inline)) {
      lane_[i] =
          static_cast<T>(f(std::integral_constant<std::size_t, static_cast<std::size_t>(i())>()));
    });
  }
  template <Alignment Tag>
  [[gnu::always_inline]] simd(const T* from, Tag tag) {
    copy_from(from, tag);
  }
  static constexpr std::size_t size() { return W; }

  [[gnu::always_inline]] T operator[](std::size_t i) const { return lane_[i]; }
  [[gnu::always_inline]] T& operator[](std::size_t i) { return lane_[i]; }
  template <Alignment Tag>
  [[gnu::always_inline]] void copy_from(const T* from, Tag) {
    each_lane<W>([&](auto i) __attribute__((always_inline)) { lane_[i] = from[i]; });
  }
  template <Alignment Tag>
  [[gnu::always_inline]] void copy_to(T* to, Tag) const {
    each_lane<W>([&](auto i) __attribute__((always_inline)) { to[i] = lane_[i]; });
  }

  [[gnu::always_inline]] simd operator-() const {
    return of([&](auto i) __attribute__((always_inline)) { return -lane_[i]; });
  }
  [[gnu::always_inline]] friend simd operator+(const simd& a, const simd& b) {
    return of([&](auto i) __attribute__((always_inline)) { return a.lane_[i] + b.lane_[i]; });
  }
  [[gnu::always_inline]] friend simd operator-(const simd& a, const simd& b) {
    return of([&](auto i) __attribute__((always_inline)) { return a.lane_[i] - b.lane_[i]; });
  }
  [[gnu::always_inline]] friend simd operator*(const simd& a, const simd& b) {
    return of([&](auto i) __attribute__((always_inline)) { return a.lane_[i] * b.lane_[i]; });
  }
  [[gnu::always_inline]] friend simd operator/(const simd& a, const simd& b) {
    return of([&](auto i) __attribute__((always_inline)) { return a.lane_[i] / b.lane_[i]; });
  }
  [[gnu::always_inline]] simd& operator+=(const simd& b) { return *this = *this + b; }
  [[gnu::always_inline]] simd& operator-=(const simd& b) { return *this = *this - b; }
  [[gnu::always_inline]] simd& operator*=(const simd& b) { return *this = *this * b; }
  [[gnu::always_inline]] simd& operator/=(const simd& b) { return *this = *this / b; }

  [[gnu::always_inline]] friend mask_type operator<(const simd& a, const simd& b) {
    return mask_type::of([&](auto i)
                             __attribute__((always_inline)) { return a.lane_[i] < b.lane_[i]; });
  }
  [[gnu::always_inline]] friend mask_type operator<=(const simd& a, const simd& b) {
    return mask_type::of([&](auto i)
                             __attribute__((always_inline)) { return a.lane_[i] <= b.lane_[i]; });
  }
  [[gnu::always_inline]] friend mask_type operator>(const simd& a, const simd& b) { return b < a; }
  [[gnu::always_inline]] friend mask_type operator>=(const simd& a, const simd& b) {
    return b <= a;
  }
  [[gnu::always_inline]] friend mask_type operator==(const simd& a, const simd& b) {
    return mask_type::of([&](auto i)
                             __attribute__((always_inline)) { return a.lane_[i] == b.lane_[i]; });
  }
  [[gnu::always_inline]] friend mask_type operator!=(const simd& a, const simd& b) {
    return mask_type::of([&](auto i)
                             __attribute__((always_inline)) { return a.lane_[i] != b.lane_[i]; });
  }

  template <class F>
  [[gnu::always_inline]] static simd of(F&& f) {
    simd x;
    each_lane<W>([&](auto i) __attribute__((always_inline)) { x.lane_[i] = f(i); });
    return x;
  }

 private:
  std::array<T, W> lane_;
};

template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> abs(const simd<T, Abi>& x) {
  return simd<T, Abi>::of([&](auto i) __attribute__((always_inline)) { return std::abs(x[i]); });
}
template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> sqrt(const simd<T, Abi>& x) {
  return simd<T, Abi>::of([&](auto i) __attribute__((always_inline)) { return std::sqrt(x[i]); });
}
/// Lane by lane; where an operand is NaN, the result is `b`.
template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> min(const simd<T, Abi>& a, const simd<T, Abi>& b) {
  return simd<T, Abi>::of([&](auto i)
                              __attribute__((always_inline)) { return a[i] < b[i] ? a[i] : b[i]; });
}
template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> max(const simd<T, Abi>& a, const simd<T, Abi>& b) {
  return simd<T, Abi>::of([&](auto i)
                              __attribute__((always_inline)) { return a[i] > b[i] ? a[i] : b[i]; });
}

template <class To, class T, class Abi>
[[gnu::always_inline]] inline To static_simd_cast(const simd<T, Abi>& x) {
  return To::of([&](auto i) __attribute__((always_inline)) {
    return static_cast<typename To::value_type>(x[i]);
  });
}

template <class T>
using native_simd = simd<T>;

template <class S>
inline constexpr bool is_simd_v = false;
template <class T, class Abi>
inline constexpr bool is_simd_v<simd<T, Abi>> = true;

/// `where(mask, x) = y` assigns y to the lanes of x that are set in the mask.
template <class T, class Abi>
class Where {
 public:
  [[gnu::always_inline]] Where(const simd_mask<T, Abi>& mask, simd<T, Abi>& value)
      : mask_(mask), value_(value) {}
  [[gnu::always_inline]] void operator=(const simd<T, Abi>& other) {
    each_lane<Abi::width>([&](auto i) __attribute__((always_inline)) {
      value_[i] = mask_[i] ? other[i] : std::as_const(value_)[i];
    });
  }

 private:
  const simd_mask<T, Abi>& mask_;
  simd<T, Abi>& value_;
};
template <class T, class Abi>
[[gnu::always_inline]] inline Where<T, Abi> where(const simd_mask<T, Abi>& mask,
                                                  simd<T, Abi>& value) {
  return {mask, value};
}

template <class T, class Abi>
[[gnu::always_inline]] inline bool all_of(const simd_mask<T, Abi>& mask) {
  return (!mask).bits() == 0;
}
template <class T, class Abi>
[[gnu::always_inline]] inline bool any_of(const simd_mask<T, Abi>& mask) {
  return mask.bits() != 0;
}
template <class T, class Abi>
[[gnu::always_inline]] inline T hmin(const simd<T, Abi>& x) {
  T least = x[0];
  each_lane<Abi::width>([&](auto i)
                            __attribute__((always_inline)) { least = std::min(least, x[i]); });
  return least;
}
template <class T, class Abi>
[[gnu::always_inline]] inline T hmax(const simd<T, Abi>& x) {
  T most = x[0];
  each_lane<Abi::width>([&](auto i)
                            __attribute__((always_inline)) { most = std::max(most, x[i]); });
  return most;
}

}  // namespace bvlab::one_lane
