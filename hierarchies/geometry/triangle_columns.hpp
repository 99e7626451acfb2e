// SPDX-License-Identifier: BSD-3-Clause
/// The corners of a mesh's triangles in the order of a topology, each coordinate of each corner in
/// an array of its own: a register's width of triangles is read without a gather. Blocks of
/// consecutive triangles have boxes.
///
/// The maximum of a value over many triangles is searched block by block. If the value is computed
/// by operations that are monotone, rounding included, in each coordinate p_j or in each |p_j -
/// c_j|, then its value at the corner of the block's box where these are largest bounds the block.
/// A block whose bound does not exceed the maximum so far is skipped. The result is that of a
/// search of all, bit for bit.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

class TriangleColumns {
 public:
  using Lanes = stdx::native_simd<double>;
  static constexpr std::size_t width = Lanes::size();
  /// Columns are padded: this many numbers may be read from any triangle on, also beyond the last.
  static constexpr std::size_t readable = width > 16 ? width : 16;
  /// Triangles in a block.
  static constexpr std::size_t block = 64;
  /// Larger ranges are searched block by block.
  static constexpr std::size_t large = 16 * block;

  /// The corners of as many triangles as there are lanes: [corner][coordinate].
  using Corners = std::array<std::array<Lanes, 3>, 3>;
  struct Box {
    Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity());
    Vec3<double> high = -low;
  };

  TriangleColumns(const TriangleMesh& mesh, std::span<const std::uint32_t> order, Threads& threads)
      : size_(order.size()),
        stride_(size_ + readable),
        coordinates_(9 * stride_),
        boxes_((size_ + block - 1) / block) {
    for (std::size_t k = 0; k < 9; ++k) std::fill_n(to(k) + size_, readable, 0.0);
    threads.share_out(boxes_.size(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t b = begin; b < end; ++b) {
        const std::size_t last = std::min(size_, (b + 1) * block);
        for (std::size_t k = b * block; k < last; ++k)
          for (std::size_t i = 0; i < 3; ++i) {
            const Vec3<double>& vertex = mesh.vertices[mesh.triangles[order[k]][i]];
            for (std::size_t j = 0; j < 3; ++j)
              to(3 * i + j)[k] = vertex[static_cast<Eigen::Index>(j)];
          }
        boxes_[b] = box_of_few(b * block, last);
      }
    });
  }

  std::size_t size() const { return size_; }
  const Box& block_box(std::size_t b) const { return boxes_[b]; }

  Vec3<double> corner(std::size_t triangle, std::size_t i) const {
    return {column(i, 0)[triangle], column(i, 1)[triangle], column(i, 2)[triangle]};
  }
  /// Coordinate j of corner i of each triangle.
  const double* column(std::size_t i, std::size_t j) const { return from(3 * i + j); }

  /// `count` triangles (one or more) from `first` on; vacant lanes repeat the last of them.
  [[gnu::always_inline]] Corners at(std::size_t first, std::size_t count) const {
    Corners corners;
    for (std::size_t k = 0; k < 9; ++k)
      corners[k / 3][k % 3].copy_from(from(k) + first, stdx::element_aligned);
    if (count < width) {
      const Lanes lane([](auto i) { return static_cast<double>(i()); });
      const auto vacant = lane >= Lanes(static_cast<double>(count));
      for (std::size_t k = 0; k < 9; ++k)
        stdx::where(vacant, corners[k / 3][k % 3]) = Lanes(from(k)[first + count - 1]);
    }
    return corners;
  }

  /// Calls what(corners, count) for the triangles from `begin` to `end`, a register at a time.
  template <class Do>
  [[gnu::always_inline]] void each(std::size_t begin, std::size_t end, Do&& what) const {
    for (std::size_t k = begin; k < end; k += width) {
      const std::size_t count = std::min(width, end - k);
      what(at(k, count), count);
    }
  }

  /// Calls whole(block) for each block inside the range, and rest(begin, end) for what is left.
  template <class Whole, class Rest>
  static void in_blocks(std::size_t begin, std::size_t end, Whole&& whole, Rest&& rest) {
    const std::size_t first = (begin + block - 1) / block, last = end / block;
    if (first >= last) return rest(begin, end);
    if (begin < first * block) rest(begin, first * block);
    for (std::size_t b = first; b < last; ++b) whole(b);
    if (last * block < end) rest(last * block, end);
  }

  /// The box around a range of triangles.
  Box box(std::size_t begin, std::size_t end) const {
    if (end - begin <= large) return box_of_few(begin, end);
    Box all;
    const auto add = [&all](const Box& box) {
      all.low = all.low.cwiseMin(box.low), all.high = all.high.cwiseMax(box.high);
    };
    in_blocks(
        begin, end, [&](std::size_t b) { add(boxes_[b]); },
        [&](std::size_t from, std::size_t to) { add(box_of_few(from, to)); });
    return all;
  }

  /// The largest |p - c|^2 of all corners p in a range, as computed: five roundings.
  double farthest_squared(std::size_t begin, std::size_t end, const Vec3<double>& c) const {
    double farthest = 0;
    const auto search = [&](std::size_t from, std::size_t to) {
      Lanes most(farthest);
      each(from, to, [&](const Corners& corners, std::size_t) {
        for (const auto& p : corners) {
          const Lanes x = p[0] - c[0], y = p[1] - c[1], z = p[2] - c[2];
          most = stdx::max(most, (x * x + y * y) + z * z);
        }
      });
      farthest = std::max(farthest, stdx::hmax(most));
    };
    if (end - begin <= large) return search(begin, end), farthest;
    const auto bound = [&](std::size_t b) {
      const Vec3<double> x =
          (boxes_[b].low - c).cwiseAbs().cwiseMax((boxes_[b].high - c).cwiseAbs());
      return (x[0] * x[0] + x[1] * x[1]) + x[2] * x[2];
    };
    std::size_t best = (begin + block - 1) / block;
    const auto ignore = [](std::size_t, std::size_t) {};
    in_blocks(
        begin, end, [&](std::size_t b) { best = bound(b) > bound(best) ? b : best; }, ignore);
    search(best * block, (best + 1) * block);
    in_blocks(
        begin, end,
        [&](std::size_t b) {
          if (bound(b) > farthest) search(b * block, (b + 1) * block);
        },
        search);
    return farthest;
  }

 private:
  /// Column 3 corner + coordinate.
  double* to(std::size_t k) { return coordinates_.data() + k * stride_; }
  const double* from(std::size_t k) const { return coordinates_.data() + k * stride_; }

  Box box_of_few(std::size_t begin, std::size_t end) const {
    std::array<Lanes, 3> low, high;
    low.fill(Lanes(std::numeric_limits<double>::infinity()));
    high.fill(Lanes(-std::numeric_limits<double>::infinity()));
    each(begin, end, [&](const Corners& corners, std::size_t) {
      for (const auto& p : corners)
        for (std::size_t j = 0; j < 3; ++j)
          low[j] = stdx::min(low[j], p[j]), high[j] = stdx::max(high[j], p[j]);
    });
    Box box;
    for (std::size_t j = 0; j < 3; ++j) {
      box.low[static_cast<Eigen::Index>(j)] = stdx::hmin(low[j]);
      box.high[static_cast<Eigen::Index>(j)] = stdx::hmax(high[j]);
    }
    return box;
  }

  std::size_t size_, stride_;
  LargeVector<double> coordinates_;  // column after column
  LargeVector<Box> boxes_;           // of each block
};

}  // namespace bvlab
