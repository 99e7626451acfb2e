// SPDX-License-Identifier: BSD-3-Clause
/// The steps of a sample of the boxes in the last two frames: whether boxes keep their motion. It
/// reads 64 boxes a frame.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "broadphase/box.hpp"

namespace bvlab {

template <class T>
class SampledSteps {
 public:
  /// Takes the boxes of a frame.
  void take(Boxes<T> boxes) {
    frames_ = boxes.size() == count_ ? frames_ + 1 : 1;
    count_ = boxes.size();
    last_.swap(before_last_);
    for (std::size_t k = 0; k < sampled(); ++k) last_[k] = lows(boxes, k);
  }
  /// The frames to come do not follow those that were taken.
  void forget() { frames_ = 0; }
  /// Whether the step to these boxes, in the mean, differs from the one before it by less than a
  /// quarter of its length; nothing where that is not known: two frames must have been taken, and
  /// the boxes have moved between them.
  std::optional<bool> steady(Boxes<T> boxes) const {
    if (frames_ < 2 || boxes.size() != count_) return {};
    double change = 0, step = 0;
    for (std::size_t k = 0; k < sampled(); ++k) {
      const Lows now = lows(boxes, k);
      for (int axis = 0; axis < 3; ++axis) {
        const double next = now[axis] - last_[k][axis],
                     last = last_[k][axis] - before_last_[k][axis];
        change += std::abs(next - last), step += std::abs(last);
      }
    }
    if (step == 0) return {};
    return change < step / 4;
  }

 private:
  static constexpr std::size_t most = 64;
  using Lows = std::array<double, 3>;

  std::size_t sampled() const { return std::min(most, count_); }
  Lows lows(Boxes<T> boxes, std::size_t k) const {
    const auto& low = boxes[count_ <= most ? k : k * (count_ / most)].lo;
    return {static_cast<double>(low[0]), static_cast<double>(low[1]), static_cast<double>(low[2])};
  }

  std::size_t count_ = 0;
  int frames_ = 0;
  std::array<Lows, most> last_{}, before_last_{};
};

}  // namespace bvlab
