// SPDX-License-Identifier: BSD-3-Clause
/// The prices of tests for each of `Adaptive`'s three alternatives (recursion, list, margins), and
/// the thresholds for changing between them.
#pragma once

#include "traversal/tracked_front.hpp"

namespace bvlab {

class AdaptivePrices {
 public:
  /// Prices in nanoseconds: of a run, of a volume test (with its posing) and of a triangle test,
  /// from least squares over replays of all volumes; of a first test with margins and of a first
  /// batch of triangles, from single pairs of bodies. The prices of all three alternatives are two
  /// thirds of this for spheres, half as much again for rectangle swept spheres; only their ratios
  /// matter here.
  struct Prices {
    double run, volumes, triangles, first_test, batch;
  };
  static constexpr Prices of_recursion{25, 14, 20, 0, 0}, of_list{25, 18, 30, 0, 120},
      of_margins{25, 28, 120, 75, 0};
  /// The price of posing the roots of two bodies, from unit costs (record cost-model): 36 ns to
  /// prepare a pose for volumes, 11 ns per volume, the mean of eight kinds.
  static constexpr double roots_posed = 2 * (36 + 11);

 protected:
  /// The cost of a recursion over both nodes relative to that of a rebuild, by these prices: fewer
  /// tests in larger batches, and no front to write.
  static constexpr double both_over_rebuild = 0.85;
  /// Motion per frame in sizes of leaves. Above `jump` no part of a front can be reused, and lists
  /// are not tried (record coherence). Below `small` margins are tried: 0.3 was the fastest of
  /// 0.15, 0.3, 0.4, 0.6 and 1.2 in the mean of 204 replays (four shapes, two volumes, motions of
  /// record coherence).
  static constexpr double jump = 4, small = 0.3;
  /// The share of the entries predicted to be due that are due: a wandering body moves away from
  /// half of what it passes.
  static constexpr double toward = 0.5;
  /// A list is dropped once it has cost this many rebuilds more than recursion. Set by hand, as are
  /// the next two: larger values lose more in failed trials, smaller ones give up too early.
  static constexpr double rebuilds_to_lose = 3;
  /// Margins are dropped once they have cost this many tests of all their entries more than a list:
  /// one for the rebuild, which is no loss if the front lasts, and one more.
  static constexpr double tests_to_lose = 2;
  /// A failed trial may cost at most 1 / patience of the runs that follow it. A list that remains
  /// long because the bodies part is rebuilt after at most `patience` complete runs.
  static constexpr double patience = 32;

  static double price(const TraversalStatistics& statistics, const Prices& prices) {
    return prices.run + prices.volumes * static_cast<double>(statistics.volumes) +
           prices.triangles * static_cast<double>(statistics.triangles) +
           (statistics.volumes + statistics.triangles > 0 ? prices.first_test : 0) +
           (statistics.triangles > 0 ? prices.batch : 0);
  }
};

}  // namespace bvlab
