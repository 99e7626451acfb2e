// SPDX-License-Identifier: BSD-3-Clause
/// Morton codes (positions along a Z-order curve): points that are near each other mostly have
/// codes that are near, too.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

namespace detail {

/// Spreads 21 bits: each is followed by two zero bits.
constexpr std::uint64_t spread_bits(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

}  // namespace detail

/// The Morton code of `point`: its cell in a grid of 2^21 cells a side over `all`, the three
/// coordinates interleaved bit by bit. Points outside get cells at the border.
inline std::uint64_t morton_code(const Vec3<double>& point, const Eigen::AlignedBox3d& all) {
  constexpr double last = (1 << 21) - 1;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = all.max()[axis] - all.min()[axis];
    const double at = (point[axis] - all.min()[axis]) / length;
    // Cell 0 where the box is flat, or so long that its length overflows.
    const auto cell = at > 0 ? static_cast<std::uint64_t>(std::min(at, 1.0) * last) : 0;
    code |= detail::spread_bits(cell) << axis;
  }
  return code;
}

/// Cells that are cubes, 2^21 a side of one from `low` on; the codes of points in them, in full or
/// their first bits.
class MortonCells {
 public:
  static constexpr int coarse_bits = 30;

  MortonCells(const Vec3<double>& low, double side) : low_(low), scale_(last / side) {
    if (!(scale_ < std::numeric_limits<double>::infinity())) scale_ = 0;
  }

  std::uint64_t fine(const Vec3<double>& point) const {
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = (point[axis] - low_[axis]) * scale_;
      const double cell = at > 0 ? std::min(at, last) : 0;  // 0 where it is not a number
      code |= detail::spread_bits(static_cast<std::uint32_t>(cell)) << axis;
    }
    return code;
  }
  std::uint32_t coarse(const Vec3<double>& point) const {
    return static_cast<std::uint32_t>(fine(point) >> (63 - coarse_bits));
  }

 private:
  static constexpr double last = (1 << 21) - 1;

  Vec3<double> low_;
  double scale_;
};

}  // namespace bvlab
