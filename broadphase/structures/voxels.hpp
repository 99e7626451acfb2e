// SPDX-License-Identifier: BSD-3-Clause
/// A grid of equal cells of about the average size of a box, along some of the three
/// axes. Boxes that are alike lie in O(1) cells each (koziara2005bounding, section 3.2).
/// Where they differ, cells grow until boxes lie in at most `limit` cells each on
/// average.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "broadphase/box.hpp"

namespace bvlab {

/// The range of cells on each axis, both ends included.
struct CellRange {
  std::int32_t first[3], last[3];
};

template <class T>
class Voxels {
 public:
  static constexpr double limit = 16;

  Voxels() = default;
  /// Cuts the axes whose entry in `cut` is true.
  Voxels(Boxes<T> boxes, std::array<bool, 3> cut) : cut_(cut) {
    double mean[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = std::numeric_limits<double>::infinity();
      double high = -low_[axis];
      for (const Box<T>& box : boxes) {
        low_[axis] = std::min<double>(low_[axis], box.lo[axis]);
        high = std::max<double>(high, box.hi[axis]);
        mean[axis] += extent(box, axis) / static_cast<double>(boxes.size());
      }
      width_[axis] = high - low_[axis];
    }
    for (double size = 1;; size *= 2) {
      for (int axis = 0; axis < 3; ++axis) set_cells(axis, size * mean[axis]);
      double sum = 0;
      for (const Box<T>& box : boxes) {
        double cells = 1;
        for (int axis = 0; axis < 3; ++axis) cells *= 1 + extent(box, axis) * scale_[axis];
        sum += cells;
      }
      if (!(sum > limit * static_cast<double>(boxes.size()))) break;
    }
  }

  /// The cell of coordinate x. Monotonic: x <= y implies that x's cell is not after y's.
  std::int32_t cell(int axis, T x) const {
    if (last_[axis] == 0) return 0;
    const double at = (static_cast<double>(x) - low_[axis]) * scale_[axis];
    return static_cast<std::int32_t>(std::min(std::max(at, 0.0), last_[axis]));
  }
  CellRange range(const Box<T>& box) const {
    CellRange r;
    for (int axis = 0; axis < 3; ++axis)
      r.first[axis] = cell(axis, box.lo[axis]), r.last[axis] = cell(axis, box.hi[axis]);
    return r;
  }
  std::int64_t count(int axis) const { return static_cast<std::int64_t>(last_[axis]) + 1; }

 private:
  static double extent(const Box<T>& box, int axis) {
    return std::min(static_cast<double>(box.hi[axis]) - static_cast<double>(box.lo[axis]),
                    std::numeric_limits<double>::max());
  }
  void set_cells(int axis, double size) {
    const double wanted = cut_[axis] ? width_[axis] / size : 1;
    // At most as many cells as fit an index; one where the axis is not cut.
    const double cells =
        wanted >= 1 && std::isfinite(width_[axis]) ? std::min(std::floor(wanted), 1e9) : 1;
    last_[axis] = cells - 1;
    scale_[axis] = cells > 1 && width_[axis] > 0 ? cells / width_[axis] : 0;
    if (!std::isfinite(scale_[axis])) last_[axis] = scale_[axis] = 0;
  }

  std::array<bool, 3> cut_{};
  double low_[3]{}, width_[3]{}, scale_[3]{}, last_[3]{};
};

/// The bucket of a cell in a hash table of 2^bits.
inline std::uint32_t cell_bucket(std::int32_t x, std::int32_t y, std::int32_t z, int bits) {
  const std::uint64_t mixed =
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15u) ^
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) * 0xc2b2ae3d27d4eb4fu) ^
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(z)) * 0x165667b19e3779f9u);
  return static_cast<std::uint32_t>((mixed * 0x9e3779b97f4a7c15u) >> (64 - bits));
}

}  // namespace bvlab
