// SPDX-License-Identifier: BSD-3-Clause
/// The pairs (node_pair.hpp) that a traversal still has to test, as an approximate priority queue:
/// it takes the pair of least order among the last 32 in the queue, which is found in registers
/// without a branch. That is nearly always the least of all. The order is the kernel's: the less it
/// is, the likelier the pair ends the search.
///
/// Where order does not matter the last pair is taken, as from a stack.
///
/// A pair may be pushed with its origin: the lane of an entry of a front that opened it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "hierarchies/wide/lanes.hpp"
#include "traversal/node_pair.hpp"

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace bvlab {

namespace detail {

/// Writes the lanes of `x` whose bits are set, side by side. May write F numbers.
template <int F>
[[gnu::always_inline]] inline void write_lanes(float* out, std::uint64_t mask,
                                               const Batch<float, F>& x) {
#if defined(__AVX512F__) && defined(__AVX512VL__)
  if constexpr (F == 16) {
    _mm512_storeu_ps(
        out, _mm512_maskz_compress_ps(static_cast<__mmask16>(mask), static_cast<__m512>(x)));
    return;
  }
  if constexpr (F == 8) {
    _mm256_storeu_ps(out,
                     _mm256_maskz_compress_ps(static_cast<__mmask8>(mask), static_cast<__m256>(x)));
    return;
  }
#endif
  write_set_lanes<F>(out, mask, [&x](int k) { return x[static_cast<std::size_t>(k)]; });
}

/// The lane of the mask with the least number, as a bit; the first if there are several, any if
/// there is a NaN.
template <class S, std::size_t parts>
[[gnu::always_inline]] inline std::uint64_t least_of(std::uint64_t mask,
                                                     const std::array<S, parts>& x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (parts == 1) {
    const __m512 others = _mm512_set1_ps(std::numeric_limits<float>::infinity());
    const __m512 all =
        _mm512_mask_mov_ps(others, static_cast<__mmask16>(mask), static_cast<__m512>(x[0]));
    const __m256 eight = _mm256_min_ps(_mm512_castps512_ps256(all), _mm512_extractf32x8_ps(all, 1));
    __m128 four = _mm_min_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps(eight, 1));
    four = _mm_min_ps(four, _mm_permute_ps(four, 0x4e));
    four = _mm_min_ps(four, _mm_permute_ps(four, 0xb1));
    // Written so that NaN is found, too.
    const std::uint64_t found =
        _mm512_cmp_ps_mask(all, _mm512_broadcastss_ps(four), _CMP_NGT_UQ) & mask;
    return found & -found;
  }
#endif
  int least = std::countr_zero(mask);
  const auto at = [&](int lane) {
    const auto k = static_cast<std::size_t>(lane);
    return x[k / S::size()][k % S::size()];
  };
  for (std::uint64_t rest = mask & (mask - 1); rest; rest &= rest - 1)
    if (at(std::countr_zero(rest)) < at(least)) least = std::countr_zero(rest);
  return std::uint64_t{1} << least;
}

}  // namespace detail

/// Which pair of a step is to be taken next; pairs are pushed accordingly.
enum class NextPair { any, nearest_child };

/// In place of the orders of pairs that are taken in any order: none is kept.
struct NoOrder {};

/// Where a pair comes from: lane k of entry e is 16 e + k. A step pushes all its lanes from one
/// entry, and passes 16 e.
using LaneOfEntry = std::uint32_t;
inline constexpr LaneOfEntry no_lane = 0xffffffffu;
/// In place of it where there is no front: none is kept.
struct NoLanes {};

/// An open pair and where it comes from; undefined if it was pushed without that.
struct OpenPair : NodePair {
  LaneOfEntry from;
};

/// The nodes of one body in sixteen lanes.
using NodesOfLanes [[gnu::vector_size(64)]] = std::uint32_t;

class WorkQueue {
 public:
  static constexpr std::size_t window = 32;

  WorkQueue() { grow(64); }

  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }

  void push(const NodePair& pair, float order, LaneOfEntry from = no_lane) {
    reserve();
    id_[0][size_] = pair.a, id_[1][size_] = pair.b, id_[2][size_] = from;
    order_[window + size_++] = order;
  }

  /// Pushes `other` with first + k of `side`, for each set bit k of the mask. `from` is NoLanes or
  /// 16 times the number of an entry.
  template <int F, class Order, class From>
  [[gnu::always_inline]] void push_lanes(int side, std::uint64_t mask, std::uint32_t first,
                                         std::uint32_t other, const Order& order, From from) {
    reserve();
    if constexpr (!std::is_same_v<From, NoLanes>)
      detail::write_numbers<F>(&id_[2][size_], mask, from);
    const std::size_t count =
        detail::write_numbers<F>(&id_[static_cast<std::size_t>(side)][size_], mask, first);
    std::fill_n(&id_[static_cast<std::size_t>(1 - side)][size_], F, other);
    if constexpr (!std::is_same_v<Order, NoOrder>)
      detail::write_lanes<F>(&order_[window + size_], mask, order);
    size_ += count;
  }

  /// The same for a pair in each of sixteen lanes.
  template <class From>
  [[gnu::always_inline]] void push_sixteen(std::uint64_t mask, const NodesOfLanes& a,
                                           const NodesOfLanes& b, NoOrder, From from) {
    reserve();
    if constexpr (!std::is_same_v<From, NoLanes>)
      detail::write_numbers<16>(&id_[2][size_], mask, from);
#if defined(__AVX512F__)
    const auto lanes = static_cast<__mmask16>(mask);
    _mm512_storeu_si512(&id_[0][size_], _mm512_maskz_compress_epi32(lanes, (__m512i)a));
    _mm512_storeu_si512(&id_[1][size_], _mm512_maskz_compress_epi32(lanes, (__m512i)b));
    size_ += static_cast<std::size_t>(std::popcount(mask));
#else
    for (; mask; mask &= mask - 1, ++size_) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
      id_[0][size_] = a[lane], id_[1][size_] = b[lane];
    }
#endif
  }
  /// The same; `order` is that of all sixteen, in registers.
  template <class S, std::size_t parts, class From>
  [[gnu::always_inline]] void push_sixteen(std::uint64_t mask, const NodesOfLanes& a,
                                           const NodesOfLanes& b,
                                           const std::array<S, parts>& order, From from) {
    reserve();
    if constexpr (!std::is_same_v<From, NoLanes>)
      detail::write_numbers<16>(&id_[2][size_], mask, from);
    float* to = &order_[window + size_];
#if defined(__AVX512F__)
    if constexpr (parts == 1) {
      const auto lanes = static_cast<__mmask16>(mask);
      _mm512_storeu_si512(&id_[0][size_], _mm512_maskz_compress_epi32(lanes, (__m512i)a));
      _mm512_storeu_si512(&id_[1][size_], _mm512_maskz_compress_epi32(lanes, (__m512i)b));
      _mm512_storeu_ps(to, _mm512_maskz_compress_ps(lanes, static_cast<__m512>(order[0])));
      size_ += static_cast<std::size_t>(std::popcount(mask));
      return;
    }
#endif
    for (; mask; mask &= mask - 1, ++size_) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
      id_[0][size_] = a[lane], id_[1][size_] = b[lane];
      *to++ = order[lane / S::size()][lane % S::size()];
    }
  }

  /// The same, the least in order last.
  template <class S, std::size_t parts, class From>
  [[gnu::always_inline]] void push_sixteen_least_last(std::uint64_t mask, const NodesOfLanes& a,
                                                      const NodesOfLanes& b,
                                                      const std::array<S, parts>& order,
                                                      From from) {
    if (mask == 0) return;
    const std::uint64_t least = detail::least_of(mask, order);
    push_sixteen(mask & ~least, a, b, order, from);
    push_sixteen(least, a, b, order, from);
  }

  OpenPair operator[](std::size_t i) const { return {{id_[0][i], id_[1][i]}, id_[2][i]}; }
  OpenPair last() const { return (*this)[size_ - 1]; }
  OpenPair take_last() { return (*this)[--size_]; }

  /// Takes the least in order of the last 32, the last if there are several, and writes its order.
  [[gnu::always_inline]] OpenPair take_least(float& order) {
    const std::size_t at = least();
    order = order_[window + at];
    const OpenPair pair = (*this)[at];
    --size_;
    for (auto& id : id_) id[at] = id[size_];
    order_[window + at] = order_[window + size_];
    return pair;
  }

 private:
  /// Of the last 32 orders the least: the last one if there are several.
  [[gnu::always_inline]] std::size_t least() const {
    using S = NativeBatch<float>;
    if constexpr (S::size() > 1) {
      constexpr std::size_t parts = window / S::size();
      const auto part = [begin = &order_[size_]](std::size_t k) {
        return S(begin + k * S::size(), stdx::element_aligned);
      };
      S of_parts = part(0);
      for (std::size_t k = 1; k < parts; ++k) of_parts = stdx::min(of_parts, part(k));
      const S value(stdx::hmin(of_parts));
      std::uint32_t found = 0;
      for (std::size_t k = 0; k < parts; ++k)  // written so that NaN is found, too
        found |= static_cast<std::uint32_t>(bits(!(part(k) > value))) << (k * S::size());
      return size_ - 1 - static_cast<std::size_t>(std::countl_zero(found));
    } else {
      std::size_t at = size_ - 1;
      float least = order_[window + at];
      for (std::size_t k = at; k-- > 0 && k + window >= size_;) {
        const float order = order_[window + k];
        at = order < least ? k : at;
        least = order < least ? order : least;
      }
      return at;
    }
  }

  [[gnu::always_inline]] void reserve() {
    if (size_ + 16 > id_[0].size()) grow(2 * id_[0].size());
  }
  /// The first order is preceded by 32 infinite ones, which are never the least. `id_[0]` grows
  /// last, since `reserve` tests its size: an allocation before may throw.
  [[gnu::noinline]] void grow(std::size_t capacity) {
    order_.resize(window + capacity + 16);
    std::fill_n(order_.begin(), window, std::numeric_limits<float>::infinity());
    id_[2].resize(capacity), id_[1].resize(capacity), id_[0].resize(capacity);
  }

  // Of a, of b, and where the pair comes from.
  std::array<std::vector<std::uint32_t>, 3> id_;
  std::vector<float> order_;
  std::size_t size_ = 0;
};

}  // namespace bvlab
