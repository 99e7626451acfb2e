// SPDX-License-Identifier: BSD-3-Clause
/// The items that top-down builds partition, and the cut of least cost by the surface-area
/// heuristic in 32 bins (goldsmith1987automatic, wald2007fast). O(n). Most ranges of a build have
/// few items: for these only the bins that hold one are visited.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab::detail {

/// An item of a partition: a triangle's centroid and its index in the mesh (exact in double). A
/// centroid is loaded as four numbers, of which the fourth is ignored.
struct CentroidOf {
  static constexpr bool has_box = false;
  static constexpr std::size_t centroid_at = 0;
  std::array<double, 4> numbers;

  CentroidOf(const Triangle& t, std::size_t i) {
    const Vec3<double> c = t[0] / 3 + t[1] / 3 + t[2] / 3;
    numbers = {c[0], c[1], c[2], static_cast<double>(i)};
  }
};
/// The same, preceded by the lower and upper corner of the triangle's box.
struct BoxOf {
  static constexpr bool has_box = true;
  static constexpr std::size_t lo_at = 0, hi_at = 3, centroid_at = 6;
  std::array<double, 10> numbers;

  BoxOf(const Triangle& t, std::size_t i) {
    const Vec3<double> lo = t[0].cwiseMin(t[1]).cwiseMin(t[2]),
                       hi = t[0].cwiseMax(t[1]).cwiseMax(t[2]), c = t[0] / 3 + t[1] / 3 + t[2] / 3;
    numbers = {lo[0], lo[1], lo[2], hi[0], hi[1], hi[2], c[0], c[1], c[2], static_cast<double>(i)};
  }
};

/// Four numbers of an item.
template <class Item>
Eigen::Map<const Eigen::Array4d> four(const Item& item, std::size_t at) {
  return Eigen::Map<const Eigen::Array4d>(item.numbers.data() + at);
}
template <class Item>
Eigen::Map<const Vec3<double>> centroid(const Item& item) {
  return Eigen::Map<const Vec3<double>>(item.numbers.data() + Item::centroid_at);
}
template <class Item>
double index(const Item& item) {
  return item.numbers[Item::centroid_at + 3];
}

/// Cuts between bins along a key.
template <class Item>
class CheapestCut {
 public:
  using Items = std::span<const Item>;

  /// The cut between bins with the least sum of (area x count) over both sides.
  template <class Key>
  static double of(Items range, const Key& key, double low, double high) {
    if constexpr (Item::has_box) {
      constexpr std::size_t count = bin_count;
      const double per_unit = count / (high - low);
      const auto bin_of = [&](const Item& item) -> std::size_t {
        // Where the range is so small that `per_unit` overflows, all are in the last bin: NaN and
        // infinity are not below `count`. Where high - low overflows, per_unit is 0: the first bin.
        const double at = (key(item) - low) * per_unit;
        return at < count ? static_cast<std::size_t>(at) : count - 1;
      };
      if (range.size() <= few) return of_few(range, bin_of, low, per_unit);
      std::array<Bin, count> bins;
      for (const Item& item : range) bins[bin_of(item)].add(item);
      std::array<double, count> right_cost;
      Bin right, left;
      double cost = 0;
      for (std::size_t k = count - 1; k > 0; --k) {
        if (bins[k].count > 0) right.add(bins[k]), cost = right.cost();
        right_cost[k] = cost;
      }
      double best = infinite, cut = low;
      for (std::size_t k = 1; k < count; ++k) {
        if (bins[k - 1].count == 0) continue;  // cut before
        left.add(bins[k - 1]);
        if (left.count == range.size()) break;
        const double both = left.cost() + right_cost[k];
        if (both < best) best = both, cut = low + static_cast<double>(k) / per_unit;
      }
      return cut;
    } else {
      return low;
    }
  }

 private:
  using Four = Eigen::Array4d;
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  static constexpr std::size_t bin_count = 32;
  /// Up to this many items, sorting them by their bins takes less time than going through all bins.
  static constexpr std::size_t few = 16;

  /// The box and number of the triangles with centroids in one part of the range.
  struct Bin {
    Four lo = Four::Constant(infinite), hi = Four::Constant(-infinite);
    std::size_t count = 0;

    void add(const Bin& other) {
      lo = lo.min(other.lo), hi = hi.max(other.hi), count += other.count;
    }
    void add(const Item& item) {
      lo = lo.min(four(item, Item::lo_at)), hi = hi.max(four(item, Item::hi_at)), ++count;
    }
    /// Half the surface area, times the count.
    double cost() const {
      if (count == 0) return 0;
      const Four d = hi - lo;
      return (d[0] * d[1] + d[1] * d[2] + d[2] * d[0]) * static_cast<double>(count);
    }
  };

  /// The same cut as `of`, bit for bit: sorts the items by their bins, and skips empty bins.
  template <class BinOf>
  static double of_few(Items range, const BinOf& bin_of, double low, double per_unit) {
    struct Binned {
      std::size_t bin;
      const Item* item;
    };
    std::array<Binned, few> sorted;
    for (std::size_t i = 0; i < range.size(); ++i) {
      const Binned next{bin_of(range[i]), &range[i]};
      std::size_t at = i;
      for (; at > 0 && sorted[at - 1].bin > next.bin; --at) sorted[at] = sorted[at - 1];
      sorted[at] = next;
    }
    std::array<double, few> right_cost;
    Bin right, left;
    for (std::size_t i = range.size(); --i > 0;)
      right.add(*sorted[i].item), right_cost[i] = right.cost();
    double best = infinite, cut = low;
    for (std::size_t i = 1; i < range.size(); ++i) {
      left.add(*sorted[i - 1].item);
      if (sorted[i - 1].bin == sorted[i].bin) continue;
      const double both = left.cost() + right_cost[i];
      if (both < best)
        best = both, cut = low + static_cast<double>(sorted[i - 1].bin + 1) / per_unit;
    }
    return cut;
  }
};

}  // namespace bvlab::detail
