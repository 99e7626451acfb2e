// SPDX-License-Identifier: BSD-3-Clause
/// Recursion (both nodes of a pair descended at once), a list or margins, whichever has been
/// cheapest lately for this pair.
///
/// Costs are counted, not timed, so that runs repeat: pairs of volumes and of triangles tested,
/// each at what it costs in that strategy (`price`; the unit is about a nanosecond with spheres).
/// What recursion costs is known while it is in use. Another strategy is tried for at most eight
/// runs: it is given up as soon as one run after its first costs twice what recursion does, or all
/// together, its building included, more than eight runs of that; else it is taken over. Each
/// failure doubles the time until the next trial, from 16 runs for a list and from 128 for margins,
/// which are expensive to build and not tried after large steps; but when the motion has fallen to
/// half of what it was at the failure, margins are tried at once. While a list or margins are in
/// use, recursion is asked for a run when they have become more expensive than it was, and takes
/// over if it is still cheaper. Both stay valid meanwhile.
#pragma once

#include <algorithm>
#include <string_view>

#include "traversal/strategies/by_cost.hpp"
#include "traversal/strategies/margins.hpp"

namespace bvlab {

class Adaptive {
 public:
  static constexpr std::string_view name = "adaptive";
  static constexpr std::string_view description =
      "recursion, a list or margins, whichever has been cheapest lately";

  template <class Pair>
  void run(const Pair& pair) {
    const double radius = follow(pair.a(), pair.b());
    if (!(step_ < hopeless * radius) && used_ != Used::recursion) drop();
    switch (used_) {
      case Used::recursion:
        return after_recursion(price(pair.template from_roots<NoFrontBoth>(), broad), radius);
      case Used::list:
        return after_other(price(list_.run(pair), plain));
      case Used::margins:
        return after_other(price(margins_.run(pair), careful));
    }
  }

  bool starts_at_roots() const { return used_ == Used::recursion; }
  void roots_are_apart() {
    // Nothing is cheaper, and how far the bodies have come is not worth finding out.
    displacement_ = -1;
    if (probing_) drop();
    probing_ = false;
    settle(apart);
  }
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    const double radius = follow(pair.a(), pair.b());
    TraversalStatistics statistics = pair.template from_roots<NoFrontBoth>(Start::below_roots);
    ++statistics.volumes;
    after_recursion(price(statistics, broad), radius);
  }

  std::size_t front_size() const { return list_.front_size() + margins_.front_size(); }

 private:
  enum class Used { recursion, list, margins };
  struct Prices {
    double run, volumes, triangles;
  };
  static constexpr Prices broad{20, 9, 25}, plain{20, 12, 25}, careful{15, 35, 100};
  static constexpr double apart = 10;  // a run that roots tested as a batch save
  static constexpr int trial = 8, probe_every = 8;
  /// Where all bodies make steps of a twenty-fifth of their radius margins have not been cheapest
  /// yet; after steps of a third nothing is where it was. Where few bodies move at a time margins
  /// stand larger steps than that, and are tried later than they might be.
  static constexpr double too_far = 0.04, hopeless = 0.3;

  /// Finds the last step; gives the mean radius of the bodies.
  double follow(MovingBody& a, MovingBody& b) {
    const double displacement = a.displacement_bound() + b.displacement_bound();
    const double radius = (a.extent().radius + b.extent().radius) / 2;
    // Before the first motion all that is known is that it may be large.
    step_ = displacement_ < 0 ? radius : displacement - displacement_;
    displacement_ = displacement;
    return radius;
  }

  static double price(const TraversalStatistics& statistics, const Prices& prices) {
    return prices.run + prices.volumes * static_cast<double>(statistics.volumes) +
           prices.triangles * static_cast<double>(statistics.triangles);
  }

  void after_recursion(double cost, double radius) {
    if (probing_) {
      probing_ = false;
      recursion_ = cost;
      if (recursion_ > other_)
        used_ = other_used_;
      else
        drop();
      return;
    }
    settle(cost);
    // Bodies far apart have gaps that no step closes.
    const bool small = step_ < too_far * radius || cost < broad.run + 8 * broad.volumes;
    if ((until_margins_ <= 0 && small) || step_ < failed_step_ / 2)
      begin(Used::margins);
    else if (until_list_ <= 0)
      begin(Used::list);
  }

  void settle(double cost) {
    recursion_ = recursion_ == 0 ? cost : 0.75 * recursion_ + 0.25 * cost;
    until_list_ -= until_list_ > 0, until_margins_ -= until_margins_ > 0;
  }

  void begin(Used other) {
    used_ = other;
    runs_ = 0;
    other_ = 0;
  }

  void after_other(double cost) {
    ++runs_;
    if (runs_ <= trial) {
      other_ += cost / trial;
      if (runs_ > 1 && cost > 2 * recursion_) return fail();
      if (other_ > recursion_) return fail();
      if (runs_ == trial) succeed();
      return;
    }
    other_ = 0.9 * other_ + 0.1 * cost;
    if (other_ > recursion_ && runs_ % probe_every == 0) {
      probing_ = true;
      other_used_ = used_;
      used_ = Used::recursion;
    }
  }

  void fail() {
    if (used_ == Used::list) {
      until_list_ = list_wait_ = std::min(2 * list_wait_, longest);
    } else {
      until_margins_ = margins_wait_ = std::min(2 * margins_wait_, longest);
      failed_step_ = step_;
    }
    drop();
  }

  void succeed() {
    if (used_ == Used::list)
      list_wait_ = 8;
    else
      margins_wait_ = 64, failed_step_ = 0;
  }

  void drop() {
    used_ = Used::recursion;
    list_.forget();
    margins_.forget();
  }

  static constexpr int longest = 1 << 14;

  ByCost list_;
  Margins margins_;
  Used used_ = Used::recursion, other_used_ = Used::recursion;
  bool probing_ = false;
  double recursion_ = 0, other_ = 0;  // mean cost of a run
  int runs_ = 0;                      // of the other
  int until_list_ = 2, until_margins_ = 1, list_wait_ = 8, margins_wait_ = 64;
  double displacement_ = -1, step_ = 0, failed_step_ = 0;
};

}  // namespace bvlab
