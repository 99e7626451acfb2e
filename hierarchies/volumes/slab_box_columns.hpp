// SPDX-License-Identifier: BSD-3-Clause
/// Fits slab-boxes to ranges of triangles in columns, a register of them at a time: the same
/// operations as SlabBox::enclosing, and so the same boxes, except in a very large range. There
/// normals are summed block by block and round differently, and the slab is measured for the
/// direction that results.
///
/// In a large range the slab is measured block by block (triangle_columns.hpp): n.(p - c), as
/// computed, is monotone in each coordinate of p, and |p - c|_1 in each |p_j - c_j|.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "hierarchies/geometry/triangle_columns.hpp"

namespace bvlab {

/// SlabBox is slab_box.hpp's.
template <class SlabBox>
class SlabBoxColumns {
 public:
  using S = typename SlabBox::scalar;
  using Lanes = TriangleColumns::Lanes;
  using Corners = TriangleColumns::Corners;
  static constexpr std::size_t width = TriangleColumns::width, block = TriangleColumns::block;
  /// Normals of larger ranges are summed block by block.
  static constexpr std::size_t very_large = 256 * block;

  SlabBoxColumns(const TriangleColumns& columns, Threads& threads)
      : columns_(columns), sums_(columns.size() > very_large ? columns.size() / block : 0) {
    threads.share_out(sums_.size(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t b = begin; b < end; ++b)
        sums_[b].fill(0), add(b * block, (b + 1) * block, sums_[b]);
    });
  }

  /// A volume around all that a box holds: its slab is as wide as the box.
  static SlabBox around(const TriangleColumns::Box& all) {
    SlabBox box = SlabBox::between(all.low, all.high);
    box.face(Vec3<double>::UnitX());
    const Vec3<double> c = box.centre.template cast<double>();
    const Vec3<double> far = (all.low - c).cwiseAbs().cwiseMax((all.high - c).cwiseAbs());
    box.bound(all.low[0] - c[0], all.high[0] - c[0], far.sum());
    return box;
  }

  /// The volume around a range of triangles, whose box is `around`.
  SlabBox volume(std::size_t begin, std::size_t end, const TriangleColumns::Box& around) const {
    SlabBox box = SlabBox::between(around.low, around.high);
    const Sums sums = sum(begin, end);
    const Vec3<double> mean(sums[0], sums[1], sums[2]);
    Mat3<double> facing;
    facing << sums[3], sums[4], sums[5], sums[4], sums[6], sums[7], sums[5], sums[7], sums[8];
    const double length = std::sqrt(squared_norm(mean));
    const bool alone = end - begin == 1 && length > 0;
    std::array<Vec3<double>, 2> directions;
    if (length > 0) directions[1] = mean / length;
    directions[0] =
        alone ? directions[1]
              : Vec3<double>(
                    Eigen::SelfAdjointEigenSolver<Mat3<double>>(facing).eigenvectors().col(2));
    if (alone || !(length > 0)) directions[1] = directions[0];
    SlabBox other = box;
    box.face(directions[0]), other.face(directions[1]);
    const Slabs slabs = measure(begin, end, box, other);
    box.bound(slabs.low[0], slabs.high[0], slabs.farthest);
    other.bound(slabs.low[1], slabs.high[1], slabs.farthest);
    return other.width < box.width ? other : box;
  }

  /// Writes the volumes of `count` single triangles from `first` on to the lanes, of which vacant
  /// ones repeat the last. Each is the volume of its triangle as `volume` has it.
  template <class AllLanes>
  void put_each(std::size_t first, std::size_t count, AllLanes& volumes) const {
    constexpr std::size_t fields = sizeof(SlabBox) / sizeof(S);
    constexpr std::size_t lanes = sizeof(AllLanes) / sizeof(SlabBox);
    constexpr std::size_t padded = (lanes + width - 1) / width * width;
    static_assert(sizeof(AllLanes) == sizeof(S) * fields * lanes);
    alignas(64) S field[fields][padded];
    std::uint64_t flat = 0;
    std::size_t filled = 0;
    for (; filled < count; filled += width)
      flat |= put_some(columns_.at(first + filled, std::min(width, count - filled)),
                       &field[0][filled], padded)
              << filled;
    for (std::size_t i = 0; i < fields; ++i)
      std::fill(field[i] + std::min(filled, padded), field[i] + padded, field[i][count - 1]);
    for (std::size_t i = 0; i < fields; ++i)
      std::memcpy(reinterpret_cast<char*>(&volumes) + sizeof(S) * i * lanes, field[i],
                  sizeof(S) * lanes);
    for (std::size_t k = 0; k < lanes; ++k)
      if (const std::size_t of = std::min(k, count - 1); flat >> of & 1) {
        const std::size_t t = first + of;
        const SlabBox box = volume(t, t + 1, columns_.box(t, t + 1));
        for (std::size_t i = 0; i < fields; ++i)
          std::memcpy(reinterpret_cast<char*>(&volumes) + sizeof(S) * (i * lanes + k),
                      reinterpret_cast<const char*>(&box) + sizeof(S) * i, sizeof(S));
      }
  }

 private:
  /// Rounds the lanes of x to S, writes them, and returns what was written.
  static Lanes rounded_lanes(const Lanes& x, S* to) {
    double lane[width];
    x.copy_to(lane, stdx::element_aligned);
    for (std::size_t i = 0; i < width; ++i) to[i] = static_cast<S>(lane[i]);
      // As in `rounded`: the optimiser must not see through the conversion.
#if defined(__GNUC__)
    asm("" : : "r"(to) : "memory");
#endif
    for (std::size_t i = 0; i < width; ++i) lane[i] = static_cast<double>(to[i]);
    return Lanes(lane, stdx::element_aligned);
  }
  /// Writes the lanes of x, none negative, rounded up to S: as rounded_up.
  static void round_up(const Lanes& x, S* to) {
    using Word = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
    double lane[width];
    x.copy_to(lane, stdx::element_aligned);
    for (std::size_t i = 0; i < width; ++i) {
      const S y = static_cast<S>(lane[i]);
      // The next larger number has the next larger word. An infinity and NaN are not below.
      to[i] = std::bit_cast<S>(std::bit_cast<Word>(y) + Word{static_cast<double>(y) < lane[i]});
    }
  }

  /// Writes the volumes of single triangles, each field `stride` after the one before. Returns the
  /// lanes of triangles without an area, whose volumes are not valid.
  static std::uint64_t put_some(const Corners& t, S* to, std::size_t stride) {
    constexpr double u = unit_roundoff<double>;
    const double tiny = std::ldexp(1.0, std::numeric_limits<double>::min_exponent / 2);
    std::array<Lanes, 3> e, f, c, n;
    for (std::size_t j = 0; j < 3; ++j) {
      const Lanes low = stdx::min(t[2][j], stdx::min(t[1][j], t[0][j]));
      const Lanes high = stdx::max(t[2][j], stdx::max(t[1][j], t[0][j]));
      c[j] = rounded_lanes(low / 2.0 + high / 2.0, to + j * stride);
      round_up(stdx::max(high - c[j], c[j] - low) * (1 + 2 * u), to + (3 + j) * stride);
      e[j] = t[1][j] - t[0][j], f[j] = t[2][j] - t[0][j];
    }
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t k = (j + 1) % 3, l = (j + 2) % 3;
      n[j] = e[k] * f[l] - e[l] * f[k];
    }
    const Lanes length = stdx::sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
    const auto with_area = bits(length > Lanes(0.0));
    for (auto& x : n) x = (x + 0.0) / length;  // + 0.0: as a sum from 0, which is never -0
    // As `face`: the x axis where the direction is no unit vector.
    const Lanes squared = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2];
    const auto usual = squared > Lanes(0.5) && squared < Lanes(SlabBox::longest_normal);
    for (std::size_t j = 0; j < 3; ++j)
      n[j] = rounded_lanes(select(usual, n[j], Lanes(j == 0 ? 1.0 : 0.0)), to + (6 + j) * stride);
    Lanes low(std::numeric_limits<double>::infinity()), high = -low, farthest(0.0);
    for (const auto& p : t) {
      const Lanes x = p[0] - c[0], y = p[1] - c[1], z = p[2] - c[2];
      const Lanes at = (n[0] * x + n[1] * y) + n[2] * z;
      low = stdx::min(at, low), high = stdx::max(at, high);
      farthest = stdx::max((stdx::abs(x) + stdx::abs(y)) + stdx::abs(z), farthest);
    }
    const Lanes middle = rounded_lanes(low / 2.0 + high / 2.0, to + 9 * stride);
    round_up((stdx::max(high - middle, middle - low) + 16 * u * farthest) + tiny, to + 10 * stride);
    return ~with_area & ((std::uint64_t{1} << width) - 1);
  }

  /// Sums over triangles of n, a normal of twice the area, and of nn' / |n|, the upper half.
  using Sums = std::array<double, 9>;

  void add(std::size_t begin, std::size_t end, Sums& sums) const {
    columns_.each(begin, end, [&](const Corners& t, std::size_t count) {
      std::array<Lanes, 3> e, f;
      for (std::size_t j = 0; j < 3; ++j) e[j] = t[1][j] - t[0][j], f[j] = t[2][j] - t[0][j];
      const std::array<Lanes, 3> n{e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2],
                                   e[0] * f[1] - e[1] * f[0]};
      const Lanes area = stdx::sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]), none(0.0);
      const auto some = area > none;
      alignas(sizeof(Lanes)) double terms[9][width];
      std::size_t k = 3;
      for (std::size_t i = 0; i < 3; ++i) {
        n[i].copy_to(terms[i], stdx::vector_aligned);
        for (std::size_t j = i; j < 3; ++j)
          select(some, n[i] * n[j] / area, none).copy_to(terms[k++], stdx::vector_aligned);
      }
      // One triangle after the other, so that registers of any width give the same sum.
      for (std::size_t lane = 0; lane < count; ++lane)
        for (std::size_t i = 0; i < 9; ++i) sums[i] += terms[i][lane];
    });
  }
  Sums sum(std::size_t begin, std::size_t end) const {
    Sums all{};
    if (end - begin <= very_large) return add(begin, end, all), all;
    TriangleColumns::in_blocks(
        begin, end,
        [&](std::size_t b) {
          for (std::size_t i = 0; i < 9; ++i) all[i] += sums_[b][i];
        },
        [&](std::size_t from, std::size_t to) { add(from, to, all); });
    return all;
  }

  /// The least and largest n.(p - c) for two normals n, and the largest |p - c|_1.
  struct Slabs {
    std::array<double, 2> low{std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::infinity()};
    std::array<double, 2> high{-low[0], -low[1]};
    double farthest = 0;
  };
  using Normals = std::array<Vec3<double>, 2>;

  void measure(std::size_t begin, std::size_t end, const Vec3<double>& c, const Normals& n,
               Slabs& slabs) const {
    std::array<Lanes, 2> low{Lanes(slabs.low[0]), Lanes(slabs.low[1])};
    std::array<Lanes, 2> high{Lanes(slabs.high[0]), Lanes(slabs.high[1])};
    Lanes farthest(slabs.farthest);
    columns_.each(begin, end, [&](const Corners& corners, std::size_t) {
      for (const auto& p : corners) {
        const Lanes x = p[0] - c[0], y = p[1] - c[1], z = p[2] - c[2];
        farthest = stdx::max((stdx::abs(x) + stdx::abs(y)) + stdx::abs(z), farthest);
        for (std::size_t i = 0; i < 2; ++i) {
          const Lanes at = (x * n[i][0] + y * n[i][1]) + z * n[i][2];
          low[i] = stdx::min(at, low[i]), high[i] = stdx::max(at, high[i]);
        }
      }
    });
    for (std::size_t i = 0; i < 2; ++i)
      slabs.low[i] = stdx::hmin(low[i]), slabs.high[i] = stdx::hmax(high[i]);
    slabs.farthest = stdx::hmax(farthest);
  }
  /// What the corners of a block's box give.
  Slabs bounds(std::size_t b, const Vec3<double>& c, const Normals& n) const {
    const auto& box = columns_.block_box(b);
    const Vec3<double> low = box.low - c, high = box.high - c;
    Slabs slabs;
    const Vec3<double> far = low.cwiseAbs().cwiseMax(high.cwiseAbs());
    slabs.farthest = (far[0] + far[1]) + far[2];
    for (std::size_t i = 0; i < 2; ++i) {
      Vec3<double> from, to;
      for (int j = 0; j < 3; ++j) {
        const double x = n[i][j] * low[j], y = n[i][j] * high[j];
        from[j] = std::min(x, y), to[j] = std::max(x, y);
      }
      slabs.low[i] = (from[0] + from[1]) + from[2], slabs.high[i] = (to[0] + to[1]) + to[2];
    }
    return slabs;
  }
  Slabs measure(std::size_t begin, std::size_t end, const SlabBox& a, const SlabBox& b) const {
    const Vec3<double> c = a.centre.template cast<double>();
    const Normals n{a.normal.template cast<double>(), b.normal.template cast<double>()};
    Slabs slabs;
    if (end - begin <= TriangleColumns::large) return measure(begin, end, c, n, slabs), slabs;
    // First the blocks that reach farthest by their bounds, so that most others are skipped.
    std::array<std::size_t, 5> best{};
    Slabs reached;
    const auto ignore = [](std::size_t, std::size_t) {};
    TriangleColumns::in_blocks(
        begin, end,
        [&](std::size_t k) {
          const Slabs of = bounds(k, c, n);
          for (std::size_t i = 0; i < 2; ++i) {
            if (of.low[i] < reached.low[i]) reached.low[i] = of.low[i], best[i] = k;
            if (of.high[i] > reached.high[i]) reached.high[i] = of.high[i], best[2 + i] = k;
          }
          if (of.farthest > reached.farthest) reached.farthest = of.farthest, best[4] = k;
        },
        ignore);
    for (const std::size_t k : best)
      if (k > 0) measure(k * block, (k + 1) * block, c, n, slabs);
    TriangleColumns::in_blocks(
        begin, end,
        [&](std::size_t k) {
          const Slabs of = bounds(k, c, n);
          if (of.low[0] < slabs.low[0] || of.low[1] < slabs.low[1] || of.high[0] > slabs.high[0] ||
              of.high[1] > slabs.high[1] || of.farthest > slabs.farthest)
            measure(k * block, (k + 1) * block, c, n, slabs);
        },
        [&](std::size_t from, std::size_t to) { measure(from, to, c, n, slabs); });
    return slabs;
  }

  const TriangleColumns& columns_;
  LargeVector<Sums> sums_;  // of each block
};

}  // namespace bvlab
