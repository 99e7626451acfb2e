// SPDX-License-Identifier: BSD-3-Clause
/// One run from a front with margins: tests the entries whose deadlines have passed, gives them new
/// ones, and opens culled pairs with small gaps into pairs with wider ones.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "traversal/queries/query.hpp"
#include "traversal/relative_motion_bound.hpp"
#include "traversal/strategies/margin_front.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

class MarginSweep : public FrontDefaults {
 public:
  static constexpr bool measures_gaps = true;
  static constexpr std::size_t held_at_least = 7;  // margins are measured for a batch at once

  /// `step`: about how much nearer the bodies come from run to run. `front` and `clock` must
  /// outlive this.
  MarginSweep(MarginFront& front, const RelativeMotionBound& clock, double step)
      : front_(front), clock_(clock), step_(step) {}

  const NodePair& operator[](std::size_t slot) const { return front_[slot]; }
  bool witnessed() const { return front_.witnessed(); }

  /// Tests the entries whose deadlines have passed, the witness first if it is one of them or the
  /// query wants a bound.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    using Query = typename Traversal::Query;
    const double now = clock_.now();
    const std::uint32_t witness = front_.witness();
    const bool first =
        front_.witnessed() && (wants_bound<Query>() || !(front_.deadline(witness) > now));
    if (first && test_witness(traversal, witness)) return true;
    auto& due = traversal.workspace().template scratch<std::vector<std::uint32_t>>();
    front_.collect(now + traversal.query().limit(), due);
    // The witness has a new deadline; if that has passed already, the front must still report it as
    // due.
    const bool still_due = first && std::erase(due, witness) > 0;
    const bool satisfied =
        traversal.test_entries(due.size(), [&](std::size_t i) { return due[i]; });
    if (still_due) front_.leave_rest();
    return satisfied;
  }

  void keep(std::size_t slot, EntryState state, double gap) {
    front_.expire_at(slot, deadline_of(state, gap));
  }
  void open(std::size_t slot) { front_.open(slot); }
  std::size_t add(const NodePair& pair, EntryState state, double gap) {
    return front_.add(pair, deadline_of(state, gap));
  }

  void finish(std::size_t witness, bool satisfied) {
    if (witness != Outcome::none) front_.bring_forward(witness);
    if (satisfied) front_.leave_rest();
  }

  /// Whether opening a culled pair saves tests. An entry with a spare gap of g costs one test in
  /// every g / step-th run, or in every run. A pair with an inner node, opened, becomes two such
  /// entries, with gaps wider by about a quarter of the size of the opened node. A pair of leaves,
  /// whose triangles cost as much as `triangle_cost` volumes, has triangles farther apart by about
  /// half of both sizes. Where gaps last for many runs anyway, opening does not pay.
  template <class Query, class Node>
  bool opens(const Query& query, const Node& a, const Node& b, double gap) const {
    constexpr double triangle_cost = 3, leaf_gain = 0.5, inner_gain = 0.25, long_enough = 4;
    const double spare = gap - query.limit();
    const bool leaves = a.count && b.count;
    const double wider = leaves ? leaf_gain * static_cast<double>(a.size + b.size)
                                : inner_gain * static_cast<double>(std::max(a.size, b.size));
    const double cost = leaves ? 1 + triangle_cost : 2;
    return spare < long_enough * step_ && cost * std::max(spare, step_) < spare + wider;
  }

  /// A pair of leaves is due when the first of its verdicts may change.
  template <class Query>
  Outcome primitives(Query& query, std::span<const Candidate> pending, Workspace& workspace) {
    if (brief_) return briefly(query, pending);
    auto& verdicts = workspace.scratch<std::vector<Verdict>>();
    verdicts.assign(pending.size(), {});
    const Outcome outcome = query.primitives(pending, verdicts);
    for (std::size_t first = 0; first < pending.size();) {
      const std::size_t slot = pending[first].slot;
      double least = std::numeric_limits<double>::infinity();
      std::size_t i = first;
      for (; i < pending.size() && pending[i].slot == slot; ++i) {
        least = std::min(least, verdicts[i].margin);
        if (verdicts[i].hit && slot != Outcome::none)
          front_.add_hit(slot, clock_.deadline(verdicts[i].margin), pending[i].a, pending[i].b);
      }
      // Two large leaves are tested in several portions: the first deadline counts.
      if (slot != Outcome::none)
        front_.expire_by(slot, least < 0 ? MarginFront::passed : clock_.deadline(least));
      first = i;
    }
    if (outcome.witness != Outcome::none)
      front_.expect(verdicts[outcome.witness].margin < lasting * step_);
    return outcome;
  }

 private:
  static constexpr double lasting = 8;     // runs for which measuring a witness's margin pays
  static constexpr std::size_t few = 512;  // pairs of triangles that are quickly tested

  double deadline_of(EntryState state, double gap) const {
    if (state == EntryState::culled) return clock_.deadline(gap);
    return state == EntryState::near ? std::numeric_limits<double>::infinity()
                                     : MarginFront::passed;
  }

  template <class Traversal>
  bool test_witness(Traversal& traversal, std::uint32_t witness) {
    const NodePair pair = front_[witness];
    if (front_.take_brief_test() && hits_still(traversal, pair, witness)) return true;
    keep(witness, EntryState::near, 0);
    traversal.hold(pair, witness);
    return traversal.flush();
  }

  /// Whether a witness whose margins never last long still hits. Does not measure its margin, which
  /// costs as much as ten such tests.
  template <class Traversal>
  bool hits_still(Traversal& traversal, const NodePair& pair, std::uint32_t witness) {
    using Query = typename Traversal::Query;
    if constexpr (DecidedByOneHit<Query>) {
      const std::size_t triangles =
          std::size_t{traversal.a().node(pair.a).count} * traversal.b().node(pair.b).count;
      if (triangles > few) return false;
      traversal.hold(pair, witness);
      brief_ = true;
      const bool satisfied = traversal.flush();
      brief_ = false;
      return satisfied;
    }
    return false;
  }
  template <class Query>
  Outcome briefly(Query& query, std::span<const Candidate> pending) {
    const Outcome outcome = query.primitives(pending);
    if (outcome.satisfied) {
      // Valid while the bodies do not move; then it is tested again.
      const Candidate& hit = pending[outcome.witness];
      front_.add_hit(hit.slot, MarginFront::passed, hit.a, hit.b);
    }
    return outcome;
  }

  MarginFront& front_;
  const RelativeMotionBound& clock_;
  double step_;
  bool brief_ = false;  // the witness is tested without its margin
};

}  // namespace bvlab
