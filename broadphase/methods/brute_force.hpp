// SPDX-License-Identifier: BSD-3-Clause
/// Compares every box with every other: n(n-1)/2 tests, the reference for all other methods.
#pragma once

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_list.hpp"

namespace bvlab {

template <class T, class Contact>
class BruteForce {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "brute-force";
  static constexpr std::string_view description = "every box against every other; the reference";

  explicit BruteForce(const MethodSettings&) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    const auto n = static_cast<std::uint32_t>(boxes.size());
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = i + 1; j < n; ++j)
        if (overlap<Contact>(boxes[i], boxes[j])) pairs_.push({i, j});
    return pairs_.view();
  }

 private:
  PairList pairs_;
};

}  // namespace bvlab
