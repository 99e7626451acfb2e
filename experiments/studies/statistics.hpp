// SPDX-License-Identifier: BSD-3-Clause
/// What many measurements are summed up by.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace bvlab {

/// The least value that `share` of all are not above; 0 where there is none. O(n). A share of 0.99
/// is of frames what a user who has a budget for each must allow.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::clamp<double>(
                                          rank, 0, static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// 0 of no values.
inline double mean(std::span<const double> values) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace bvlab
