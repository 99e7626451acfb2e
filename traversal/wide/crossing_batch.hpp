// SPDX-License-Identifier: BSD-3-Clause
/// A batch of triangles that crossed in the last frame, one pair of triangles for each pair of
/// bodies. Their margins are measured eight at a time: how far the bodies can move before the
/// triangles no longer cross (triangle_margin.hpp).
#pragma once

#include <array>
#include <cstddef>

#include "traversal/primitives/triangle_margin.hpp"

namespace bvlab {

class CrossingBatch {
 public:
  CrossingBatch() {
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t k = 0; k < width; ++k) pointers_[side][k] = &triangles_[side][k];
  }

  /// Adds the triangles of pair `p`, in the world frame. The batch must not be full.
  void add(std::size_t p, const Triangle& a, const Triangle& b) {
    triangles_[0][used_] = a, triangles_[1][used_] = b;
    pairs_[used_++] = p;
  }
  bool full() const { return used_ == width; }

  /// Calls `found(pair, margin)` for each pair added; its margin is above 0 only where the
  /// triangles cross for certain. Counts the tests.
  template <class Counter, class Found>
  void test(Counter& counter, Found&& found) {
    if (used_ == 0) return;
    std::array<double, width> margins;
    crossing_margins<>(pointers_[0].data(), pointers_[1].data(), static_cast<int>(used_),
                       margins.data());
    counter.primitives(used_);
    for (std::size_t k = 0; k < used_; ++k) found(pairs_[k], margins[k]);
    used_ = 0;
  }

 private:
  static constexpr std::size_t width = 8;

  std::array<std::array<Triangle, width>, 2> triangles_;
  std::array<std::array<const Triangle*, width>, 2> pointers_;
  std::array<std::size_t, width> pairs_;
  std::size_t used_ = 0;
};

}  // namespace bvlab
