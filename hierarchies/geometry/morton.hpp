// SPDX-License-Identifier: BSD-3-Clause
/// Morton codes (positions along a Z-order curve): points that are near each other mostly have
/// codes that are near, too.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>

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

}  // namespace bvlab
