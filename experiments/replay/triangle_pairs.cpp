// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/triangle_pairs.hpp"

#include <cmath>

#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {

static constexpr std::size_t numbers_per_pair = 18;

std::vector<Triangle> read_triangle_pairs(const std::string& path) {
  const std::size_t shape[] = {any_length, numbers_per_pair};
  const Array<double> array = read_npy<double>(path, shape);
  for (std::size_t i = 0; i < array.data.size(); ++i)
    if (!std::isfinite(array.data[i]))
      throw Unusable(path, "pair " + std::to_string(i / numbers_per_pair) + ", number " +
                               std::to_string(i % numbers_per_pair) + " is " +
                               (std::isnan(array.data[i]) ? "NaN" : "infinite"));
  std::vector<Triangle> triangles(array.data.size() / 9);
  for (std::size_t i = 0; i < array.data.size(); ++i)
    triangles[i / 9][i % 9 / 3][static_cast<Eigen::Index>(i % 3)] = array.data[i];
  return triangles;
}

std::vector<std::uint8_t> verdicts_on(const std::vector<Triangle>& triangles, TriangleTest test) {
  constexpr std::size_t most = 64;
  std::vector<std::uint8_t> verdicts(triangles.size() / 2);
  for (std::size_t first = 0; first < verdicts.size(); first += most) {
    const std::size_t count = std::min(most, verdicts.size() - first);
    const Triangle *a[most], *b[most];
    for (std::size_t i = 0; i < count; ++i)
      a[i] = &triangles[2 * (first + i)], b[i] = &triangles[2 * (first + i) + 1];
    const std::uint64_t hits = test(a, b, static_cast<int>(count));
    for (std::size_t i = 0; i < count; ++i) verdicts[first + i] = hits >> i & 1;
  }
  return verdicts;
}

}  // namespace bvlab
