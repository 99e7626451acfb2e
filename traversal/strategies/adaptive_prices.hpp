// SPDX-License-Identifier: BSD-3-Clause
/// What tests cost in each of `Adaptive`'s three ways, and when it changes from one to another.
#pragma once

#include <cmath>
#include <cstddef>

#include "hierarchies/hierarchy_extent.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

class AdaptivePrices {
 public:
  /// Nanoseconds of a run, of a volume test (with what posing it takes) and of a triangle test,
  /// from least squares over replays of all volumes; of a first look with margins and of a first
  /// batch of triangles, from single pairs of bodies. Spheres cost two thirds of this, rectangle
  /// swept spheres half as much again, in each of the three ways. Only the ratios between the ways
  /// matter here.
  struct Prices {
    double run, volumes, triangles, look, batch;
  };
  static constexpr Prices broad{25, 14, 20, 0, 0}, plain{25, 18, 30, 0, 120},
      careful{25, 28, 120, 75, 0};
  /// Nanoseconds of posing the roots of two bodies, from unit costs (record cost-model): 36 to
  /// prepare a pose for volumes, 11 for a volume, the mean of eight kinds.
  static constexpr double roots_posed = 2 * (36 + 11);

 protected:
  /// Cost of a recursion over both nodes over that of a rebuild, by these prices: fewer tests in
  /// larger batches, and no front to write.
  static constexpr double both_over_rebuild = 0.85;
  /// Motion from frame to frame in sizes of leaves. Above `jump` nothing of a front survives and
  /// lists are not tried (record coherence). Margins are tried below `small`: gaps are some half a
  /// leaf wide, so after steps of m leaves an entry comes up in 2m of the runs. With two triangles
  /// to three volumes it then costs three times what it costs a list: that pays up to m = 0.15.
  static constexpr double jump = 4, small = 0.15;
  /// The share that does come up of the entries that could: bodies that wander come back, and leave
  /// half of what they pass behind.
  static constexpr double toward = 0.5;
  /// Chosen, as are `patience` and `look_every`: more is lost in vain, less gives up too early.
  static constexpr double recursions_to_lose = 3;
  /// In looks at all entries of a front with margins: the look of a rebuild, which is no loss if it
  /// lasts, and one more. Chosen, too.
  static constexpr double looks_to_lose = 2;
  /// A vain trial, and the rebuild of a list that stays long because bodies part, may cost one part
  /// in so many.
  static constexpr double patience = 32;

  /// Of a surface of so many leaves, about as wide as long, in units of the mesh.
  static double leaf_size(const HierarchyExtent& extent) {
    return 2 * extent.radius / std::sqrt(static_cast<double>(extent.leaves));
  }

  static double price(const TraversalStatistics& statistics, const Prices& prices) {
    return prices.run + prices.volumes * static_cast<double>(statistics.volumes) +
           prices.triangles * static_cast<double>(statistics.triangles) +
           (statistics.volumes + statistics.triangles > 0 ? prices.look : 0) +
           (statistics.triangles > 0 ? prices.batch : 0);
  }
};

}  // namespace bvlab
