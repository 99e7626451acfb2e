// SPDX-License-Identifier: BSD-3-Clause
/// Batches on the compilers' built-in vector types, which replace std::experimental::simd where the
/// compiler is clang: with libstdc++ 12, clang miscompiles a blend of AVX-512 (simd_x86.h,
/// _S_blend_avx512), and libc++ has next to none of it. It has only the members that the engine
/// uses, as `one_lane` does.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace bvlab::vector_lanes {

struct element_aligned_tag {};
struct vector_aligned_tag {};
inline constexpr element_aligned_tag element_aligned{};
inline constexpr vector_aligned_tag vector_aligned{};

namespace simd_abi {
template <int W>
struct lanes {
  static constexpr int width = W;
};
template <class, int W>
using deduce_t = lanes<W>;
}  // namespace simd_abi

namespace detail {

template <class T, int W>
struct VectorOf {
  static_assert(std::has_single_bit(static_cast<unsigned>(W)));
  using type [[gnu::vector_size(sizeof(T) * W)]] = T;
};
/// W numbers in the compiler's built-in vector type.
template <class T, int W>
using Vector = typename VectorOf<T, W>::type;

/// The lane type of a comparison: all bits set, or none.
template <class T>
using Word = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;

#if defined(BVLAB_REGISTER_BYTES)  // those of another processor, to count as it does
inline constexpr int register_bytes = BVLAB_REGISTER_BYTES;
#elif defined(__AVX512F__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

template <int W, class F>
[[gnu::always_inline]] constexpr void each_lane(F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) {
    (f(std::integral_constant<std::size_t, i>()), ...);
  }(std::make_integer_sequence<int, W>());
}

/// Square roots, a register at a time.
template <class T, int W>
[[gnu::always_inline]] inline Vector<T, W> root(const Vector<T, W>& x) {
  if constexpr (sizeof x > register_bytes) {
    Vector<T, W / 2> half[2];
    std::memcpy(half, &x, sizeof x);
    for (auto& each : half) each = root<T, W / 2>(each);
    return std::bit_cast<Vector<T, W>>(half);
  }
#if defined(__AVX512F__)
  if constexpr (sizeof x == 64 && sizeof(T) == 4)
    return std::bit_cast<Vector<T, W>>(_mm512_sqrt_ps(std::bit_cast<__m512>(x)));
  if constexpr (sizeof x == 64 && sizeof(T) == 8)
    return std::bit_cast<Vector<T, W>>(_mm512_sqrt_pd(std::bit_cast<__m512d>(x)));
#endif
#if defined(__AVX__)
  if constexpr (sizeof x == 32 && sizeof(T) == 4)
    return std::bit_cast<Vector<T, W>>(_mm256_sqrt_ps(std::bit_cast<__m256>(x)));
  if constexpr (sizeof x == 32 && sizeof(T) == 8)
    return std::bit_cast<Vector<T, W>>(_mm256_sqrt_pd(std::bit_cast<__m256d>(x)));
#endif
#if defined(__SSE2__)
  if constexpr (sizeof x == 16 && sizeof(T) == 4)
    return std::bit_cast<Vector<T, W>>(_mm_sqrt_ps(std::bit_cast<__m128>(x)));
  if constexpr (sizeof x == 16 && sizeof(T) == 8)
    return std::bit_cast<Vector<T, W>>(_mm_sqrt_pd(std::bit_cast<__m128d>(x)));
#endif
  Vector<T, W> result;
  each_lane<W>([&](auto i) { result[i()] = std::sqrt(x[i()]); });
  return result;
}

}  // namespace detail

template <class T, class Abi>
class simd_mask {
 public:
  static constexpr int W = Abi::width;
  using Words = detail::Vector<detail::Word<T>, W>;

  simd_mask() = default;
  explicit simd_mask(bool all) : words_(Words{} - static_cast<detail::Word<T>>(all)) {}
  explicit simd_mask(const Words& words) : words_(words) {}
  static constexpr std::size_t size() { return W; }

  bool operator[](std::size_t i) const { return words_[i] != 0; }
  const Words& words() const { return words_; }

  /// Bit i is set where lane i is true.
  [[gnu::always_inline]] std::uint64_t bits() const {
#if defined(__clang__) && __clang_major__ >= 15
    if constexpr (W < 8) {
      // Boolean vectors of fewer than eight lanes are not reliable.
      return [&]<int... i>(std::integer_sequence<int, i...>) {
        const auto eight = __builtin_shufflevector(words_, Words{}, (i < W ? i : W)...);
        typedef bool Bools __attribute__((ext_vector_type(8)));
        return __builtin_bit_cast(std::uint8_t, __builtin_convertvector(eight != 0, Bools));
      }(std::make_integer_sequence<int, 8>());
    } else {
      typedef bool Bools __attribute__((ext_vector_type(W)));
      using Bits = std::conditional_t<W == 8, std::uint8_t,
                                      std::conditional_t<W == 16, std::uint16_t, std::uint32_t>>;
      return __builtin_bit_cast(Bits, __builtin_convertvector(words_ != 0, Bools));
    }
#else
    std::uint64_t result = 0;
    detail::each_lane<W>([&](auto i) { result |= std::uint64_t{words_[i()] != 0} << i(); });
    return result;
#endif
  }

  friend simd_mask operator&&(const simd_mask& a, const simd_mask& b) {
    return simd_mask(a.words_ & b.words_);
  }
  friend simd_mask operator||(const simd_mask& a, const simd_mask& b) {
    return simd_mask(a.words_ | b.words_);
  }
  friend simd_mask operator&(const simd_mask& a, const simd_mask& b) { return a && b; }
  friend simd_mask operator|(const simd_mask& a, const simd_mask& b) { return a || b; }
  friend simd_mask operator^(const simd_mask& a, const simd_mask& b) {
    return simd_mask(a.words_ ^ b.words_);
  }
  friend simd_mask operator!=(const simd_mask& a, const simd_mask& b) { return a ^ b; }
  friend simd_mask operator==(const simd_mask& a, const simd_mask& b) { return !(a ^ b); }
  simd_mask operator!() const { return simd_mask(~words_); }
  simd_mask& operator&=(const simd_mask& b) { return *this = *this && b; }
  simd_mask& operator|=(const simd_mask& b) { return *this = *this || b; }

 private:
  Words words_;
};

template <class T, class Abi = simd_abi::lanes<detail::register_bytes / sizeof(T)>>
class simd {
 public:
  static constexpr int W = Abi::width;
  using value_type = T;
  using mask_type = simd_mask<T, Abi>;
  using Vector = detail::Vector<T, W>;

  simd() = default;
  template <class N>
    requires std::is_arithmetic_v<N>
  simd(N all) : lanes_(Vector{} + static_cast<T>(all)) {
    // Vector{} + -0.0 is 0.0: a lone zero is written as it is.
    if constexpr (std::is_floating_point_v<T>)
      detail::each_lane<W>([&](auto i) { lanes_[i()] = static_cast<T>(all); });
  }
  template <class F>
    requires requires(F f) { f(std::integral_constant<std::size_t, 0>()); }
  explicit simd(F&& f) {
    detail::each_lane<W>([&](auto i) { lanes_[i()] = static_cast<T>(f(i)); });
  }
  explicit simd(const Vector& lanes) : lanes_(lanes) {}
  /// Conversion from the types of intrinsics, and back.
  template <class R>
    requires(!std::is_class_v<R> && !std::is_arithmetic_v<R> && !std::is_same_v<R, Vector> &&
             !std::is_pointer_v<R> && sizeof(R) == sizeof(Vector))
  explicit simd(const R& lanes) : lanes_(std::bit_cast<Vector>(lanes)) {}
  template <class R>
    requires(!std::is_class_v<R> && !std::is_arithmetic_v<R> && sizeof(R) == sizeof(Vector))
  explicit operator R() const {
    return std::bit_cast<R>(lanes_);
  }
  template <class Tag>
  simd(const T* from, Tag tag) {
    copy_from(from, tag);
  }
  static constexpr std::size_t size() { return W; }

  /// One lane, to be read or written.
  class Lane {
   public:
    Lane(Vector& lanes, std::size_t i) : lanes_(lanes), i_(i) {}
    operator T() const { return lanes_[i_]; }
    T operator=(T x) { return lanes_[i_] = x; }

   private:
    Vector& lanes_;
    std::size_t i_;
  };
  T operator[](std::size_t i) const { return lanes_[i]; }
  Lane operator[](std::size_t i) { return {lanes_, i}; }
  const Vector& lanes() const { return lanes_; }
  void copy_from(const T* from, element_aligned_tag) { std::memcpy(&lanes_, from, sizeof lanes_); }
  void copy_from(const T* from, vector_aligned_tag) {
    std::memcpy(&lanes_, __builtin_assume_aligned(from, sizeof lanes_), sizeof lanes_);
  }
  void copy_to(T* to, element_aligned_tag) const { std::memcpy(to, &lanes_, sizeof lanes_); }
  void copy_to(T* to, vector_aligned_tag) const {
    std::memcpy(__builtin_assume_aligned(to, sizeof lanes_), &lanes_, sizeof lanes_);
  }

  simd operator-() const { return simd(-lanes_); }
  friend simd operator+(const simd& a, const simd& b) { return simd(a.lanes_ + b.lanes_); }
  friend simd operator-(const simd& a, const simd& b) { return simd(a.lanes_ - b.lanes_); }
  friend simd operator*(const simd& a, const simd& b) { return simd(a.lanes_ * b.lanes_); }
  friend simd operator/(const simd& a, const simd& b) { return simd(a.lanes_ / b.lanes_); }
  simd& operator+=(const simd& b) { return *this = *this + b; }
  simd& operator-=(const simd& b) { return *this = *this - b; }
  simd& operator*=(const simd& b) { return *this = *this * b; }
  simd& operator/=(const simd& b) { return *this = *this / b; }

  friend mask_type operator<(const simd& a, const simd& b) { return mask(a.lanes_ < b.lanes_); }
  friend mask_type operator<=(const simd& a, const simd& b) { return mask(a.lanes_ <= b.lanes_); }
  friend mask_type operator>(const simd& a, const simd& b) { return mask(a.lanes_ > b.lanes_); }
  friend mask_type operator>=(const simd& a, const simd& b) { return mask(a.lanes_ >= b.lanes_); }
  friend mask_type operator==(const simd& a, const simd& b) { return mask(a.lanes_ == b.lanes_); }
  friend mask_type operator!=(const simd& a, const simd& b) { return mask(a.lanes_ != b.lanes_); }

 private:
  template <class Words>
  [[gnu::always_inline]] static mask_type mask(const Words& words) {
    return mask_type(std::bit_cast<typename mask_type::Words>(words));
  }
  Vector lanes_;
};

template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> blend(const simd_mask<T, Abi>& mask,
                                                 const simd<T, Abi>& yes, const simd<T, Abi>& no) {
  return simd<T, Abi>(mask.words() ? yes.lanes() : no.lanes());
}

template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> abs(const simd<T, Abi>& x) {
  using Words = typename simd_mask<T, Abi>::Words;
  constexpr auto sign = std::numeric_limits<detail::Word<T>>::min();
  return simd<T, Abi>(std::bit_cast<typename simd<T, Abi>::Vector>(std::bit_cast<Words>(x.lanes()) &
                                                                   ~(Words{} + sign)));
}
template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> sqrt(const simd<T, Abi>& x) {
  return simd<T, Abi>(detail::root<T, Abi::width>(x.lanes()));
}
/// Lane by lane; where an operand is NaN, the result is `b`.
template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> min(const simd<T, Abi>& a, const simd<T, Abi>& b) {
  return blend(a < b, a, b);
}
template <class T, class Abi>
[[gnu::always_inline]] inline simd<T, Abi> max(const simd<T, Abi>& a, const simd<T, Abi>& b) {
  return blend(a > b, a, b);
}

template <class To, class T, class Abi>
[[gnu::always_inline]] inline To static_simd_cast(const simd<T, Abi>& x) {
  return To(__builtin_convertvector(x.lanes(), typename To::Vector));
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
  Where(const simd_mask<T, Abi>& mask, simd<T, Abi>& value) : mask_(mask), value_(value) {}
  [[gnu::always_inline]] void operator=(const simd<T, Abi>& other) {
    value_ = blend(mask_, other, value_);
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

namespace detail {
/// Reduces the upper half onto the lower, again and again.
template <class T, class Abi, class Better>
[[gnu::always_inline]] inline T reduced(const simd<T, Abi>& x, const Better& better) {
  alignas(sizeof x) T lane[Abi::width];
  x.copy_to(lane, vector_aligned);
  for (int half = Abi::width / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) lane[i] = better(lane[i], lane[i + half]);
  return lane[0];
}
}  // namespace detail

template <class T, class Abi>
T hmin(const simd<T, Abi>& x) {
  return detail::reduced(x, [](T a, T b) { return a < b ? a : b; });
}
template <class T, class Abi>
T hmax(const simd<T, Abi>& x) {
  return detail::reduced(x, [](T a, T b) { return a > b ? a : b; });
}

}  // namespace bvlab::vector_lanes

/// @cond
/// Batches have an alignment of their own, which is larger than Eigen's for plain numbers.
template <class T, class Abi, int Size>
struct Eigen::internal::compute_default_alignment<bvlab::vector_lanes::simd<T, Abi>, Size> {
  enum { value = 0 };
};
/// @endcond
