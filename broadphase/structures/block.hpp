// SPDX-License-Identifier: BSD-3-Clause
/// Sixteen boxes in arrays, one array per coordinate, compared with one box at once: six vector
/// comparisons in AVX-512; narrower registers compare four boxes at a time. Empty lanes hold a
/// sentinel that overlaps nothing. Pairs are packed to the left as they are written, as in
/// published box pruning (BibTeX: terdiman2018boxpruning).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "broadphase/box.hpp"
#include "broadphase/structures/four.hpp"

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace bvlab {

/// One bit per lane of a block.
using LaneMask = std::uint32_t;
inline constexpr int block_width = 16;
inline constexpr LaneMask all_lanes = 0xffff;

template <class T>
struct alignas(64) Block {
  T lo[3][block_width];
  T hi[3][block_width];

  Box<T> box(int lane) const {
    return {{lo[0][lane], lo[1][lane], lo[2][lane]}, {hi[0][lane], hi[1][lane], hi[2][lane]}};
  }
  void put(int lane, const Box<T>& box) {
    for (int axis = 0; axis < 3; ++axis)
      lo[axis][lane] = box.lo[axis], hi[axis][lane] = box.hi[axis];
  }
};

/// The sentinel: lo is +infinity and hi is -infinity, so it overlaps nothing.
template <class T>
constexpr Box<T> nowhere() {
  constexpr T far = std::numeric_limits<T>::infinity();
  return {{far, far, far}, {-far, -far, -far}};
}

template <class T>
Box<T> enclosing(const Box<T>& a, const Box<T>& b) {
  Box<T> both;
  for (int axis = 0; axis < 3; ++axis) {
    both.lo[axis] = a.lo[axis] < b.lo[axis] ? a.lo[axis] : b.lo[axis];
    both.hi[axis] = a.hi[axis] > b.hi[axis] ? a.hi[axis] : b.hi[axis];
  }
  return both;
}

/// The lanes of `block` whose boxes overlap `box`: six comparisons of sixteen lanes, or twelve of
/// eight, in AVX-512; the block is read in place.
template <class Contact, class T>
[[gnu::always_inline]] inline LaneMask overlapping_lanes(const Block<T>& block, const Box<T>& box) {
#ifdef __AVX512F__
  constexpr int le = std::is_same_v<Contact, Closed> ? _CMP_LE_OQ : _CMP_LT_OQ;
  constexpr int ge = std::is_same_v<Contact, Closed> ? _CMP_GE_OQ : _CMP_GT_OQ;
  if constexpr (std::is_same_v<T, float>) {
    __mmask16 m = 0xffff, n = 0xffff;  // each masked by the ones before
    for (int axis = 0; axis < 3; ++axis) {
      m = _mm512_mask_cmp_ps_mask(m, _mm512_load_ps(block.lo[axis]), _mm512_set1_ps(box.hi[axis]),
                                  le);
      n = _mm512_mask_cmp_ps_mask(n, _mm512_load_ps(block.hi[axis]), _mm512_set1_ps(box.lo[axis]),
                                  ge);
    }
    return static_cast<LaneMask>(m & n);
  }
  if constexpr (std::is_same_v<T, double>) {
    LaneMask lanes = 0;
    for (int first = 0; first < block_width; first += 8) {
      __mmask8 m = 0xff, n = 0xff;
      for (int axis = 0; axis < 3; ++axis) {
        m = _mm512_mask_cmp_pd_mask(m, _mm512_load_pd(block.lo[axis] + first),
                                    _mm512_set1_pd(box.hi[axis]), le);
        n = _mm512_mask_cmp_pd_mask(n, _mm512_load_pd(block.hi[axis] + first),
                                    _mm512_set1_pd(box.lo[axis]), ge);
      }
      lanes |= static_cast<LaneMask>(m & n) << first;
    }
    return lanes;
  }
#else
  const auto all = [](T x) { return Four<T>{x, x, x, x}; };
  LaneMask lanes = 0;
  for (int first = 0; first < block_width; first += 4) {
    const auto held = [&](const T* numbers) {
      Four<T> four;
      std::memcpy(&four, numbers + first, sizeof four);
      return four;
    };
    auto four = all(0) < all(1);  // all bits are set
    for (int axis = 0; axis < 3; ++axis)
      four &= Contact::reaches(all(box.hi[axis]), held(block.lo[axis])) &
              Contact::reaches(held(block.hi[axis]), all(box.lo[axis]));
    lanes |= static_cast<LaneMask>(signs(reinterpret_cast<Four<T> >(four))) << first;
  }
  return lanes;
#endif
}

/// The box that encloses all lanes; empty lanes have no effect.
template <class T>
inline Box<T> bounds(const Block<T>& block) {
  Box<T> all;
  for (int axis = 0; axis < 3; ++axis) {
    T lo[block_width], hi[block_width];
    for (int lane = 0; lane < block_width; ++lane)
      lo[lane] = block.lo[axis][lane], hi[lane] = block.hi[axis][lane];
    for (int half = block_width / 2; half > 0; half /= 2)
      for (int lane = 0; lane < half; ++lane) {
        lo[lane] = lo[lane] < lo[lane + half] ? lo[lane] : lo[lane + half];
        hi[lane] = hi[lane] > hi[lane + half] ? hi[lane] : hi[lane + half];
      }
    all.lo[axis] = lo[0], all.hi[axis] = hi[0];
  }
  return all;
}
#ifdef __AVX512F__
namespace detail {
// Masked intrinsics with full masks: for the plain ones GCC warns of uninitialised operands.
inline __m512 least_of(__m512 a, __m512 b) { return _mm512_maskz_min_ps(0xffff, a, b); }
template <int Order>
inline __m512 quarters(__m512 a) {
  return _mm512_maskz_shuffle_f32x4(0xffff, a, a, Order);
}
template <int Order>
inline __m512 within(__m512 a) {
  return _mm512_maskz_permute_ps(0xffff, a, Order);
}
/// The smallest lanes of a, b, c and d, in lanes 0, 1, 2 and 3.
inline __m128 least_lanes(__m512 a, __m512 b, __m512 c, __m512 d) {
  const auto pairs = [](__m512 x, __m512 y) {  // x's quarters folded into two, then y's
    return least_of(_mm512_maskz_shuffle_f32x4(0xffff, x, y, 0x44),
                    _mm512_maskz_shuffle_f32x4(0xffff, x, y, 0xee));
  };
  const __m512 ab = pairs(a, b), cd = pairs(c, d);
  const __m512 q = least_of(_mm512_maskz_shuffle_f32x4(0xffff, ab, cd, 0x88),
                            _mm512_maskz_shuffle_f32x4(0xffff, ab, cd, 0xdd));  // a quarter each
  __m512 m = least_of(q, within<0x4e>(q));
  m = least_of(m, within<0xb1>(m));
  return _mm512_castps512_ps128(_mm512_maskz_permutexvar_ps(
      0xf, _mm512_setr_epi32(0, 4, 8, 12, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0), m));
}
}  // namespace detail
/// The same, with all six reductions done together.
template <>
inline Box<float> bounds(const Block<float>& block) {
  const __m512 sign = _mm512_set1_ps(-0.0f);
  const auto negated = [&](const float* x) {
    return _mm512_castsi512_ps(_mm512_xor_si512(_mm512_load_si512(x), _mm512_castps_si512(sign)));
  };
  alignas(16) float lower[4], upper[4];
  const __m512 z = negated(block.hi[2]);
  _mm_store_ps(lower, detail::least_lanes(_mm512_load_ps(block.lo[0]), _mm512_load_ps(block.lo[1]),
                                          _mm512_load_ps(block.lo[2]), z));
  _mm_store_ps(upper, detail::least_lanes(negated(block.hi[0]), negated(block.hi[1]), z, z));
  return {{lower[0], lower[1], lower[2]}, {-upper[0], -upper[1], -upper[2]}};
}
#endif

/// Loads sixteen consecutive boxes of a frame.
template <class T>
inline void load(Block<T>& block, const Box<T>* boxes) {
  for (int lane = 0; lane < block_width; ++lane) block.put(lane, boxes[lane]);
}
#ifdef __AVX512F__
namespace detail {
/// Lane l takes the number 6 l + Component of the 96 in `v`: `index` says which of the 32 of a
/// register pair, `lanes_from` which pair.
template <int Component>
inline __m512 every_sixth(const __m512 (&v)[6]) {
  alignas(64) static constexpr auto at = [] {
    std::array<std::int32_t, 16> a{};
    for (int l = 0; l < 16; ++l) a[l] = (6 * l + Component) % 32;
    return a;
  }();
  constexpr auto lanes_from = [](int pair) {
    unsigned m = 0;
    for (int l = 0; l < 16; ++l) m |= unsigned((6 * l + Component) / 32 == pair) << l;
    return static_cast<__mmask16>(m);
  };
  const __m512i index = _mm512_load_si512(at.data());
  __m512 r = _mm512_permutex2var_ps(v[0], index, v[1]);
  r = _mm512_mask_mov_ps(r, lanes_from(1), _mm512_permutex2var_ps(v[2], index, v[3]));
  return _mm512_mask_mov_ps(r, lanes_from(2), _mm512_permutex2var_ps(v[4], index, v[5]));
}
}  // namespace detail
template <>
inline void load(Block<float>& block, const Box<float>* boxes) {
  static_assert(sizeof(Box<float>) == 6 * sizeof(float));
  const auto* numbers = reinterpret_cast<const float*>(boxes);
  __m512 v[6];
  for (int k = 0; k < 6; ++k) v[k] = _mm512_loadu_ps(numbers + 16 * k);
  _mm512_store_ps(block.lo[0], detail::every_sixth<0>(v));
  _mm512_store_ps(block.lo[1], detail::every_sixth<1>(v));
  _mm512_store_ps(block.lo[2], detail::every_sixth<2>(v));
  _mm512_store_ps(block.hi[0], detail::every_sixth<3>(v));
  _mm512_store_ps(block.hi[1], detail::every_sixth<4>(v));
  _mm512_store_ps(block.hi[2], detail::every_sixth<5>(v));
}
#endif

/// Writes a pair for every lane of `lanes`: ids[lane] and `id`, the smaller first. May write to
/// sixteen places from `out` on; returns the end of the valid ones.
inline Pair* write_pairs(Pair* out, std::uint32_t id, const std::uint32_t* ids, LaneMask lanes) {
#ifdef __AVX512F__
  const __m512i packed =
      _mm512_maskz_compress_epi32(static_cast<__mmask16>(lanes), _mm512_loadu_si512(ids));
  const __m512i other = _mm512_set1_epi32(static_cast<int>(id));
  const __m512i first = _mm512_maskz_min_epu32(0xffff, packed, other);
  const __m512i second = _mm512_maskz_max_epu32(0xffff, packed, other);
  const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i high =
      _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  _mm512_storeu_si512(out, _mm512_permutex2var_epi32(first, low, second));
  const int found = std::popcount(lanes);
  _mm512_storeu_si512(out + 8, _mm512_permutex2var_epi32(first, high, second));
  return out + found;
#else
  for (; lanes; lanes &= lanes - 1) *out++ = ordered(id, ids[std::countr_zero(lanes)]);
  return out;
#endif
}

/// Writes `first` + lane to `out` and `other` to `others` for every lane of `lanes`. Both need room
/// for sixteen; returns the number of lanes.
inline std::size_t write_lanes(std::uint32_t* out, std::uint32_t* others, std::uint32_t first,
                               std::uint32_t other, LaneMask lanes) {
#ifdef __AVX512F__
  const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(
                               static_cast<__mmask16>(lanes),
                               _mm512_add_epi32(lane, _mm512_set1_epi32(static_cast<int>(first)))));
  _mm512_storeu_si512(others, _mm512_set1_epi32(static_cast<int>(other)));
  return static_cast<std::size_t>(std::popcount(lanes));
#else
  std::size_t count = 0;
  for (; lanes; lanes &= lanes - 1, ++count)
    out[count] = first + static_cast<std::uint32_t>(std::countr_zero(lanes)), others[count] = other;
  return count;
#endif
}

/// Writes a pair of slots for every lane of `lanes`: `slot`, whose box is `id`, and `first` + lane,
/// whose box is ids[lane]; the slot of the smaller id first. Room as for `write_pairs`.
inline Pair* write_pairs_by_id(Pair* out, std::uint32_t slot, std::uint32_t id, std::uint32_t first,
                               const std::uint32_t* ids, LaneMask lanes) {
#ifdef __AVX512F__
  const auto held = static_cast<__mmask16>(lanes);
  const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m512i others = _mm512_maskz_compress_epi32(
      held, _mm512_add_epi32(lane, _mm512_set1_epi32(static_cast<int>(first))));
  const __m512i their_ids = _mm512_maskz_compress_epi32(held, _mm512_loadu_si512(ids));
  const __m512i mine = _mm512_set1_epi32(static_cast<int>(slot));
  const __mmask16 smaller =
      _mm512_cmplt_epu32_mask(their_ids, _mm512_set1_epi32(static_cast<int>(id)));
  const __m512i one = _mm512_mask_blend_epi32(smaller, mine, others);
  const __m512i two = _mm512_mask_blend_epi32(smaller, others, mine);
  const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i high =
      _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  const int found = std::popcount(lanes);
  _mm512_storeu_si512(out, _mm512_permutex2var_epi32(one, low, two));
  if (found > 8) _mm512_storeu_si512(out + 8, _mm512_permutex2var_epi32(one, high, two));
  return out + found;
#else
  for (; lanes; lanes &= lanes - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
    *out++ = ids[lane] < id ? Pair{first + lane, slot} : Pair{slot, first + lane};
  }
  return out;
#endif
}

}  // namespace bvlab
