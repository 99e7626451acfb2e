// SPDX-License-Identifier: BSD-3-Clause
/// A set of whole numbers that changes little from frame to frame, in few bytes: of each frame the
/// numbers that came or went. They are sorted, and each is written as its distance from the one
/// before it, after their count; all in groups of seven bits, the lowest first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

namespace bvlab {

class SetsOverTime {
 public:
  /// The set in the next frame; duplicates count once. O(n log n).
  void add(std::vector<std::uint32_t> now) {
    std::sort(now.begin(), now.end());
    now.erase(std::unique(now.begin(), now.end()), now.end());
    changed_.clear();
    std::set_symmetric_difference(now.begin(), now.end(), last_.begin(), last_.end(),
                                  std::back_inserter(changed_));
    put(static_cast<std::uint32_t>(changed_.size()));
    std::uint32_t before = 0;
    for (const auto number : changed_) put(number - std::exchange(before, number));
    last_ = std::move(now);
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  void put(std::uint32_t number) {
    for (; number > 127; number >>= 7) bytes_.push_back(static_cast<std::uint8_t>(number | 128));
    bytes_.push_back(static_cast<std::uint8_t>(number));
  }

  std::vector<std::uint32_t> last_, changed_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace bvlab
