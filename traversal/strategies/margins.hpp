// SPDX-License-Identifier: BSD-3-Clause
/// A front with margins: tests only those entries whose gaps the bodies can have closed since they
/// were measured. Verdicts on triangles are reused within their margins.
///
/// The cost of a run follows the motion, not the length of the front: an entry of gap g costs one
/// test in about g / (motion per run) runs. So it pays to open pairs that are apart by a small gap:
/// two children with wide gaps cost less than a parent with a narrow one (MarginSweep::opens).
///
/// A gap shrinks by at most the motion of a sphere around one of its two nodes since it was
/// measured (measured_gaps.hpp). Where all gaps last, a run compares two numbers
/// (lasting_answer.hpp).
///
/// Where the bodies move so far that few gaps last until the next run, none are measured
/// (measuring_rule.hpp).
///
/// The front is rebuilt from the roots when the smoothed cost of a run exceeds the mean cost since
/// the last rebuild, that rebuild included. This replaces a front that is too long because the
/// bodies moved apart.
///
/// A run in which nothing is due costs tens of nanoseconds. When the query differs from that
/// of the last run, all entries are due. The parameters of a query must not change between
/// runs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "traversal/front.hpp"
#include "traversal/lasting_answer.hpp"
#include "traversal/strategies/margin_sweep.hpp"

namespace bvlab {

class Margins {
 public:
  static constexpr std::string_view name = "margins";
  static constexpr std::string_view description =
      "a front whose entries are retested only once the bodies can have closed their gaps";

  template <class Pair>
  TraversalStatistics run(const Pair& pair) {
    if (quiet(pair)) return {};
    return test_due(pair);
  }

  /// The first half of a run: if nothing is due, gives the query the last answer and returns true.
  /// Then the run is over.
  template <class Pair>
  bool quiet(const Pair& pair) {
    return !front_.empty() && unchanged(pair.a(), pair.b(), pair.query());
  }
  /// The second half of a run: tests the due entries.
  template <class Pair>
  TraversalStatistics test_due(const Pair& pair) {
    MovingBody &a = pair.a(), &b = pair.b();
    auto& query = pair.query();
    using Query = typename Pair::Query;
    if (front_.empty() || rebuild_due_) rebuild(a, b);
    // Verdicts found by one query do not serve another: one may stop at the first hit of an
    // entry.
    if (last_query_ != &Query::name) {
      front_.expire();
      measuring_rule_.ignore_earlier();
    }
    last_query_ = &Query::name;
    front_.prefetch();
    PresentPoses now(a, b);
    if constexpr (Query::one_hit_is_enough)
      if (const float margin = repeat_hits(query, now); margin > 0) {
        answer_lasts(a, b, margin);
        return {};
      }
    MarginSweep sweep(front_, now, measuring_rule_, step_);
    const TraversalStatistics statistics = pair.from_front(sweep);
    added_ += sweep.entries_added();
    account(statistics);
    ended_by_hit_ = !statistics.everything;
    has_all_hits_ = sweep.measures();
    // A gap matters once it has come down to the query's limit.
    const bool by_gaps = statistics.everything && !wants_bound<Query>();
    answer_lasts(a, b, sweep.least() - (by_gaps ? query.limit() : 0));
    if constexpr (requires { query.nearest(); }) nearest_ = query.nearest();
    return statistics;
  }

  /// The next run starts from the roots.
  void forget() { front_.clear(); }

  /// The next run starts from the first `count` entries of a list, as if a rebuild had just left
  /// them; `step` is about how much nearer the bodies come from run to run.
  void start_from(const Front& list, std::size_t count, MovingBody& a, MovingBody& b, double step) {
    front_.clear();
    rebuild(a, b);
    // So that the next run sees a move by `step`.
    displacement_ -= step;
    epoch_a_ = a.epoch() - 1, epoch_b_ = b.epoch() - 1;
    front_.open(0);
    for (std::size_t slot = 0; slot < count; ++slot) front_.add(list[slot]);
    if (list.witnessed()) front_.set_witness(0);
    cost_ = static_cast<double>(count);  // a rebuild tests about twice as many pairs as it leaves
    last_query_ = nullptr;
  }

  /// Sets whether the witness is expected to last so short that measuring its margin does not pay.
  void expect(bool soon) { front_.expect(soon); }

  /// The second half without a rebuild. The front may be incomplete: where no hit is found, the
  /// query is not answered yet.
  template <class Pair>
  TraversalStatistics test_without_rebuild(const Pair& pair) {
    rebuild_due_ = false;
    return test_due(pair);
  }

  /// The share of the last run's entries that is due in a run, if each run brings the bodies nearer
  /// by `step`: an entry whose gap is g is due in every (g / step)-th run.
  double due_in_a_run(double step) const {
    const auto share = [&](double gap) { return gap > step ? step / gap : 1; };
    if (ended_by_hit_) return share(gap_);
    double due = 0;
    for (std::size_t slot = 0; slot < front_.size(); ++slot) due += share(front_.gap(slot));
    return due / static_cast<double>(front_.size());
  }
  /// How often the front has been rebuilt from the roots, or started from a list.
  std::uint32_t rebuilds() const { return rebuilds_; }

  std::size_t front_size() const { return front_.size(); }
  /// About how many entries a list would have: without those that opening culled pairs has added.
  std::size_t entries_of_list() const { return front_.size() - std::min(front_.size(), added_); }
  const MarginFront& front() const { return front_; }

 private:
  static constexpr double triangles = 4;  // cost of a pair of triangles and of its margin, in pairs
                                          // of volumes

  /// Follows the bodies. If nothing can have changed, answers the query and returns true.
  template <class Query>
  bool unchanged(MovingBody& a, MovingBody& b, Query& query) {
    const double displacement = a.displacement_bound() + b.displacement_bound();
    // By epochs: a short step can be lost in the sum of two long displacement bounds.
    const bool moved = a.epoch() != epoch_a_ || b.epoch() != epoch_b_;
    epoch_a_ = a.epoch(), epoch_b_ = b.epoch();
    if (moved) {
      // Displacement bounds are sums of many steps, rounded up; the rounding of their own sum is
      // added.
      step_ = displacement - displacement_ + 4 * unit_roundoff<double> * displacement;
      displacement_ = displacement;
    }
    measuring_rule_.begin_run(moved ? step_ : 0);
    if (last_query_ != &Query::name) return false;
    if constexpr (requires { query.nearest(); }) {
      if (!moved) query.repeat(nearest_);
      return !moved;
    } else {
      if (moved ? !still_lasts(a, b) : !has_all_hits_) return false;
      const auto& hits = front_.hits();
      for (std::size_t i = Query::one_hit_is_enough ? front_.repeated_hit() : 0; i < hits.size();
           ++i)
        if (query.known(hits[i].a, hits[i].b)) break;
      return true;
    }
  }

  /// Whether the bodies cannot have closed the gap of the last answer.
  bool still_lasts(MovingBody& a, MovingBody& b) {
    if (displacement_ < valid_until_) return true;
    const double remaining = lasting_.remaining(a, b);
    if (remaining > 0) valid_until_ = displacement_at_expiry(displacement_, remaining);
    return remaining > 0;
  }
  /// The answer just found lasts until the bodies have closed `gap`.
  void answer_lasts(MovingBody& a, MovingBody& b, double gap) {
    gap_ = gap;
    if (gap > step_) {
      lasting_.restart(a, b, gap);
      valid_until_ = displacement_at_expiry(displacement_, gap);
    } else {  // it would hardly last until the next run
      lasting_.forget();
      valid_until_ = never;
    }
  }

  /// Passes the hits that still last to the query. If they satisfy it, returns what is left of the
  /// margin of the last one; else 0, and then the entries of the others are due.
  template <class Query>
  float repeat_hits(Query& query, const PresentPoses& now) {
    for (std::size_t i = 0; i < front_.hits().size(); ++i) {
      const KnownHit& hit = front_.hits()[i];
      const float remaining = front_.remaining_of_hit(i, now);
      if (remaining > 0 && query.known(hit.a, hit.b)) {
        front_.repeat_hit(i);
        return remaining;
      }
    }
    // They will be found again. Their entries are due even if the run ends before they are tested.
    for (const KnownHit& hit : front_.hits()) front_.forget_gap(hit.slot);
    front_.clear_hits();
    return 0;
  }

  void rebuild(MovingBody& a, MovingBody& b) {
    if (front_.empty()) {
      measuring_rule_ = MeasuringRule(mean_step(a, b), mean_leaf_size(a, b));
      displacement_ = a.displacement_bound() + b.displacement_bound();
      epoch_a_ = a.epoch(), epoch_b_ = b.epoch();
    }
    front_.restart();
    added_ = 0;
    measuring_rule_.ignore_earlier();
    upkeep_ = cost_ = 0;
    runs_ = 0;
    rebuild_due_ = false;
    ++rebuilds_;
  }

  void account(const TraversalStatistics& statistics) {
    const double cost = static_cast<double>(statistics.volumes) +
                        triangles * static_cast<double>(statistics.triangles);
    cost_ += cost;
    if (++runs_ == 1) return;
    upkeep_ = 0.75 * upkeep_ + 0.25 * cost;
    rebuild_due_ = upkeep_ * runs_ > cost_;
  }

  static constexpr double never = -1;

  MarginFront front_;
  MeasuringRule measuring_rule_;
  LastingAnswer lasting_;
  std::uint32_t epoch_a_ = 0, epoch_b_ = 0;  // at the last run
  double displacement_ = 0;                  // of both bodies, at the last run
  double step_ = 0;                          // bound on how much nearer since the last run
  double valid_until_ = never;               // the answer lasts while displacements sum to less
  double gap_ = 0;                           // for which the last answer lasts
  NearestTriangles nearest_;
  double upkeep_ = 0, cost_ = 0, runs_ = 0;  // smoothed cost of a run; totals since the rebuild
  std::size_t added_ = 0;  // entries that opening culled pairs has added since the rebuild
  std::uint32_t rebuilds_ = 0;
  bool rebuild_due_ = false;
  bool has_all_hits_ = true;  // the last sweep measured: the front has all of its hits
  bool ended_by_hit_ = false;
  const std::string_view* last_query_ = nullptr;  // the query of the last run
};

}  // namespace bvlab
