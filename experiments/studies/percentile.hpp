// SPDX-License-Identifier: BSD-3-Clause
/// The frame that one in a hundred is slower than: what a user who has a budget for each must
/// allow.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace bvlab {

/// The least value that `share` of all are not above; 0 where there is none. O(n).
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::clamp<double>(
                                          rank, 0, static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace bvlab
