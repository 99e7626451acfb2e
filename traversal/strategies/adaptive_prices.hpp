// SPDX-License-Identifier: BSD-3-Clause
/// The prices of tests in each of `Adaptive`'s three ways, and the thresholds for changing ways.
#pragma once

#include <cmath>
#include <cstddef>

#include "hierarchies/hierarchy_extent.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

class AdaptivePrices {
 public:
  /// Prices in nanoseconds: of a run, of a volume test (with its posing) and of a triangle test,
  /// from least squares over replays of all volumes; of a first test with margins and of a first
  /// batch of triangles, from single pairs of bodies. Spheres cost two thirds of this, rectangle
  /// swept spheres half as much again, in each of the three ways. Only the ratios between the ways
  /// matter here.
  struct Prices {
    double run, volumes, triangles, first_test, batch;
  };
  static constexpr Prices broad{25, 14, 20, 0, 0}, plain{25, 18, 30, 0, 120},
      careful{25, 28, 120, 75, 0};
  /// The price of posing the roots of two bodies, from unit costs (record cost-model): 36 ns to
  /// prepare a pose for volumes, 11 ns per volume, the mean of eight kinds.
  static constexpr double roots_posed = 2 * (36 + 11);

 protected:
  /// The cost of a recursion over both nodes relative to that of a rebuild, by these prices: fewer
  /// tests in larger batches, and no front to write.
  static constexpr double both_over_rebuild = 0.85;
  /// Motion per frame in sizes of leaves. Above `jump` no part of a front can be reused, and lists
  /// are not tried (record coherence). Below `small` margins are tried: gaps are about half a leaf
  /// wide, so after steps of m leaves an entry is due in 2m of the runs. With two triangles to
  /// three volumes it then costs three times what it costs a list: that pays up to m = 0.15.
  static constexpr double jump = 4, small = 0.15;
  /// The share of the expected entries that are really due: bodies that wander return, and depart
  /// from half of what they pass.
  static constexpr double toward = 0.5;
  /// Chosen, as is `patience`: larger values lose more in failed trials, smaller give up too early.
  static constexpr double recursions_to_lose = 3;
  /// In tests of all entries of a front with margins: that of a rebuild, which is no loss if it
  /// lasts, and one more. Chosen, too.
  static constexpr double tests_to_lose = 2;
  /// A failed trial, and the rebuild of a list that remains long because bodies part, may cost at
  /// most one part in this many.
  static constexpr double patience = 32;

  /// The size of a leaf, in units of the mesh, for leaves about as wide as long.
  static double leaf_size(const HierarchyExtent& extent) {
    return 2 * extent.radius / std::sqrt(static_cast<double>(extent.leaves));
  }

  static double price(const TraversalStatistics& statistics, const Prices& prices) {
    return prices.run + prices.volumes * static_cast<double>(statistics.volumes) +
           prices.triangles * static_cast<double>(statistics.triangles) +
           (statistics.volumes + statistics.triangles > 0 ? prices.first_test : 0) +
           (statistics.triangles > 0 ? prices.batch : 0);
  }
};

}  // namespace bvlab
