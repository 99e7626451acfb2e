// SPDX-License-Identifier: BSD-3-Clause
/// The triangle test of contact queries, in two phases. The first tests a triangle of a against a
/// leaf of b (or four against four): their boxes, then b's corners against the plane of a's
/// triangle. It takes forty operations and leaves one lane in ten. The second packs what many
/// leaves have left, and the filter of triangles tests full registers. N_p counts the lanes of the
/// first phase.
///
/// Rounding in the first phase. Let d be CornerTransform::error_bound. Coordinates of a's corners
/// have errors below d > 16 e (r_a + |t|) + 2 e r_b, with r the reaches and e the unit roundoff, so
/// they are at most r_a + |t| + d. Corners of b have errors up to e r_b < d / 2: in all, 3/2 d.
///
/// Boxes of a are grown by 9/4 d. That product and its sum with a coordinate are rounded, with an
/// error of at most e (r_a + |t| + 6 d) < d / 8: a face moves by more than 2 d, and 3/2 d suffice.
///
/// Planes. Whatever n is, triangles are apart if their intervals of n.x are. Let N = |n_x| + |n_y|
/// + |n_z|. The ends are off by 3/2 N d by the corners; by 3.1 e N times the largest coordinate by
/// three roundings of each product, below 0.2 N d for a and 1.6 N d for b; and by less than
/// N d / 8 by rounding N, 4 N d and the grown ends: 3.5 N d in all. The interval of a is grown by
/// 4 N d, and by the least normal number, which covers six products that underflow gradually.
///
/// Overflow. Nothing is apart by its plane unless 4 N d < 2^100; then N times any coordinate, which
/// is at most d / (2 e), is less than 2^121. Where d is not below 2^100 it is taken to be infinite,
/// and so are boxes and intervals. Comparisons with NaN are false.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hierarchies/wide/lanes.hpp"
#include "hierarchies/wide/triangle_lanes.hpp"
#include "traversal/primitives/triangle_filter.hpp"
#include "traversal/wide/leaf_tests.hpp"
#include "traversal/wide/relative_frame.hpp"

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace bvlab {

template <Batched S, int F>
[[gnu::always_inline]] inline Corners<S> corners_in_lanes(const TriangleLanes<float, F>& from) {
  Corners<S> corner;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      corner[i][k] = S(from.corner[i][k].data(), stdx::vector_aligned);
  return corner;
}

/// The boxes of triangles, one per lane.
template <Batched S>
struct TriangleBoxes {
  std::array<S, 3> low, high;

  [[gnu::always_inline]] explicit TriangleBoxes(const Corners<S>& corner) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = filter::min(filter::min(corner[0][k], corner[1][k]), corner[2][k]);
      high[k] = filter::max(filter::max(corner[0][k], corner[1][k]), corner[2][k]);
    }
  }
};

/// The triangles of a leaf of a in the frame of b, with their boxes and their intervals along their
/// normals, both grown by the error bounds. Computed in lanes; read one triangle at a time.
template <int F>
class TransformedLeaf {
  using S = Batch<float, F>;

 public:
  /// Takes the triangles of a leaf in place of those that it holds.
  [[gnu::noinline]] void transform_all(const TriangleLanes<float, F>& own,
                                       const CornerTransform& transform) {
    off_ = transform.error_bound() < most_known ? transform.error_bound() : infinity;
    Corners<S> corner = corners_in_lanes<S>(own);
    for (std::size_t i = 0; i < 3; ++i) {
      corner[i] = transform(corner[i][0], corner[i][1], corner[i][2]);
      for (std::size_t k = 0; k < 3; ++k)
        corner[i][k].copy_to(transformed_.corner[i][k].data(), stdx::vector_aligned);
    }
    const TriangleBoxes<S> boxes(corner);
    const S grown(2.25f * off_);
    for (std::size_t k = 0; k < 3; ++k) {
      (boxes.low[k] - grown).copy_to(low_[k].data(), stdx::vector_aligned);
      (boxes.high[k] + grown).copy_to(high_[k].data(), stdx::vector_aligned);
    }
    put_planes(corner);
  }
  const TriangleLanes<float, F>& corners() const { return transformed_; }
  /// The error bound of each coordinate.
  float off() const { return off_; }
  /// The grown boxes, as low[coordinate][lane].
  const std::array<std::array<float, F>, 3>& low() const { return low_; }
  const std::array<std::array<float, F>, 3>& high() const { return high_; }

  /// The lanes whose boxes overlap that of triangle `k` and whose corners are not all outside its
  /// interval along its normal.
  [[gnu::always_inline]] std::uint64_t near(std::size_t k, const Corners<S>& corner,
                                            const TriangleBoxes<S>& boxes) const {
    Mask<S> apart(false);
    for (std::size_t i = 0; i < 3; ++i)
      apart = apart | (boxes.low[i] > S(high_[i][k])) | (boxes.high[i] < S(low_[i][k]));
    const S x(normal_[0][k]), y(normal_[1][k]), z(normal_[2][k]);
    const auto along = [&](std::size_t i) __attribute__((always_inline)) {
      return fused<S>(z, corner[i][2], fused<S>(y, corner[i][1], x * corner[i][0]));
    };
    const S p = along(0), q = along(1), r = along(2);
    apart = apart | (filter::min(filter::min(p, q), r) > S(most_[k])) |
            (filter::max(filter::max(p, q), r) < S(least_[k]));
    return ~bits(apart);
  }
  /// Of each triangle, its normal, of any length, and its interval along that, grown.
  const std::array<std::array<float, F>, 3>& normal() const { return normal_; }
  const std::array<float, F>& least() const { return least_; }
  const std::array<float, F>& most() const { return most_; }

 private:
  [[gnu::always_inline]] void put_planes(const Corners<S>& corner) {
    using namespace filter;
    const Vector<S> normal = cross<S>(corner[1] - corner[0], corner[2] - corner[0]);
    S along[3];
    for (std::size_t i = 0; i < 3; ++i)
      along[i] = fused<S>(normal[2], corner[i][2],
                          fused<S>(normal[1], corner[i][1], normal[0] * corner[i][0]));
    const S grown =
        fused<S>(abs(normal[0]) + abs(normal[1]) + abs(normal[2]), S(4 * off_), S(tiny));
    const Mask<S> known = grown < S(most_known);
    const S least = min(min(along[0], along[1]), along[2]) - grown,
            most = max(max(along[0], along[1]), along[2]) + grown;
    select<S>(known, least, S(-infinity)).copy_to(least_.data(), stdx::vector_aligned);
    select<S>(known, most, S(infinity)).copy_to(most_.data(), stdx::vector_aligned);
    for (std::size_t k = 0; k < 3; ++k)
      select<S>(known, normal[k], S(0)).copy_to(normal_[k].data(), stdx::vector_aligned);
  }

  using Lanes = std::array<float, F>;
  static constexpr float tiny = std::numeric_limits<float>::min(), most_known = 0x1p100f,
                         infinity = std::numeric_limits<float>::infinity();

  float off_;
  TriangleLanes<float, F> transformed_;
  alignas(sizeof(float) * F) std::array<Lanes, 3> low_, high_;
  // Of each triangle, its normal, of any length (0 if not usable), and its interval along it.
  alignas(sizeof(float) * F) std::array<Lanes, 3> normal_;
  alignas(sizeof(float) * F) Lanes least_, most_;
};

/// Pairs of triangles side by side, in the frame of b.
class ContactBatch {
 public:
  ContactBatch() : number_{}, corner_{} {}

  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ >= enough; }

  /// Adds triangle k of `a` with each triangle of `b` whose bit is set in `lanes`. Triangles are
  /// numbered from first_a and first_b on. The batch must have room.
  template <int F>
  [[gnu::always_inline]] void add(std::uint64_t lanes, const TriangleLanes<float, F>& a,
                                  std::size_t k, std::uint32_t first_a,
                                  const TriangleLanes<float, F>& b, std::uint32_t first_b) {
#if defined(__AVX512F__)
    if constexpr (F == 16) {
      const __m512i all = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
      const __m512i lane = _mm512_maskz_compress_epi32(static_cast<__mmask16>(lanes), all);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          _mm512_storeu_ps(&corner_[0][i][j][size_], _mm512_set1_ps(a.corner[i][j][k]));
          _mm512_storeu_ps(&corner_[1][i][j][size_],
                           _mm512_permutexvar_ps(lane, _mm512_load_ps(b.corner[i][j].data())));
        }
      _mm512_storeu_si512(&number_[0][size_], _mm512_set1_epi32(static_cast<int>(first_a + k)));
      _mm512_storeu_si512(&number_[1][size_],
                          _mm512_add_epi32(lane, _mm512_set1_epi32(static_cast<int>(first_b))));
      size_ += static_cast<std::size_t>(std::popcount(lanes));
      return;
    }
#endif
    for (; lanes; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      put(a, k, first_a, b, lane, first_b);
    }
  }

  /// The same for up to four triangles of each: lane 4 i + j is of triangle i of a and j of b.
  [[gnu::always_inline]] void add(std::uint64_t lanes, const TriangleLanes<float, 4>& a,
                                  std::uint32_t first_a, const TriangleLanes<float, 4>& b,
                                  std::uint32_t first_b) {
#if defined(__AVX512F__)
    const __m512i all = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    const __m512i lane = _mm512_maskz_compress_epi32(static_cast<__mmask16>(lanes), all),
                  of_a = _mm512_srli_epi32(lane, 2),
                  of_b = _mm512_and_si512(lane, _mm512_set1_epi32(3));
    const auto picked = [](const __m512i& index, const std::array<float, 4>& four) {
      return _mm512_permutexvar_ps(index, _mm512_castps128_ps512(_mm_load_ps(four.data())));
    };
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        _mm512_storeu_ps(&corner_[0][i][j][size_], picked(of_a, a.corner[i][j]));
        _mm512_storeu_ps(&corner_[1][i][j][size_], picked(of_b, b.corner[i][j]));
      }
    _mm512_storeu_si512(&number_[0][size_],
                        _mm512_add_epi32(of_a, _mm512_set1_epi32(static_cast<int>(first_a))));
    _mm512_storeu_si512(&number_[1][size_],
                        _mm512_add_epi32(of_b, _mm512_set1_epi32(static_cast<int>(first_b))));
    size_ += static_cast<std::size_t>(std::popcount(lanes));
#else
    for (; lanes; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      put(a, lane / 4, first_a, b, lane % 4, first_b);
    }
#endif
  }

  enum class Decide { full_registers, all };
  /// Tests full registers of pairs, or all that are left, and calls take(a, b, meeting) with the
  /// numbers of those that are not certainly apart until it returns true. Returns whether it has.
  template <Batched S, class Take>
  [[gnu::always_inline]] bool decide(Decide which, float off, Take&& take) {
    constexpr std::size_t width = S::size();
    const std::size_t end = which == Decide::all ? size_ : size_ / width * width;
    for (std::size_t first = 0; first < end; first += width) {
      const auto [meeting, apart] = verdicts<S>(first, off);
      const std::size_t used = std::min(width, end - first);
      std::uint64_t left = ~apart & ((std::uint64_t{1} << used) - 1);
      for (; left; left &= left - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(left));
        if (take(number_[0][first + lane], number_[1][first + lane], (meeting >> lane & 1) != 0))
          return true;
      }
    }
    keep_from<width>(end);
    return false;
  }

 private:
  /// Four times sixteen pairs may be added to a batch that is not full.
  static constexpr std::size_t enough = 64, room = enough + 4 * 16;

  /// Tests a register of pairs. Out of line: it knows neither the query nor the memory.
  template <Batched S>
  [[gnu::noinline]] VerdictLanes verdicts(std::size_t first, float off) const {
    const auto verdict = certainly_within<S>(corners<S>(0, first), corners<S>(1, first), S(off));
    return {bits(verdict.meeting), bits(verdict.apart)};
  }
  template <Batched S>
  [[gnu::always_inline]] Corners<S> corners(std::size_t side, std::size_t first) const {
    Corners<S> of;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        of[i][j] = S(&corner_[side][i][j][first], stdx::vector_aligned);
    return of;
  }
  template <int F>
  [[gnu::always_inline]] void put(const TriangleLanes<float, F>& a, std::size_t k,
                                  std::uint32_t first_a, const TriangleLanes<float, F>& b,
                                  std::size_t lane, std::uint32_t first_b) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        corner_[0][i][j][size_] = a.corner[i][j][k];
        corner_[1][i][j][size_] = b.corner[i][j][lane];
      }
    number_[0][size_] = first_a + static_cast<std::uint32_t>(k);
    number_[1][size_] = first_b + static_cast<std::uint32_t>(lane);
    ++size_;
  }
  /// Moves the pairs from `end` on, fewer than a register, to the front.
  template <std::size_t width>
  void keep_from(std::size_t end) {
    size_ -= end;
    if (size_ == 0) return;
    for (auto& number : number_) std::copy_n(&number[end], width, &number[0]);
    for (auto& side : corner_)
      for (auto& corner : side)
        for (auto& lanes : corner) std::copy_n(&lanes[end], width, &lanes[0]);
  }

  std::size_t size_ = 0;
  std::array<std::array<std::uint32_t, room>, 2> number_;
  alignas(64) std::array<std::array<std::array<std::array<float, room>, 3>, 3>, 2> corner_;
};

}  // namespace bvlab
