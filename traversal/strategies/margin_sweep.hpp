// SPDX-License-Identifier: BSD-3-Clause
/// One run from a front with margins: of its entries those are looked at whose deadlines have
/// passed, and given new ones; pairs that are apart, but hardly, are opened for wider gaps.
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
  static constexpr std::size_t held_at_least = 7;  // margins are found for a batch at once

  /// `step`: how much nearer the bodies come from run to run, about. Both others are to stay.
  MarginSweep(MarginFront& front, const RelativeMotionBound& clock, double step)
      : front_(front), clock_(clock), step_(step) {}

  const NodePair& operator[](std::size_t slot) const { return front_[slot]; }
  bool witnessed() const { return front_.witnessed(); }

  /// The entries whose deadlines have passed, the witness first where it is one of them or a bound
  /// is wanted.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    using Query = typename Traversal::Query;
    const double now = clock_.now();
    const std::uint32_t witness = front_.witness();
    const bool first =
        front_.witnessed() && (wants_bound<Query>() || !(front_.deadline(witness) > now));
    if (first && look_at_witness(traversal, witness)) return true;
    auto& due = traversal.workspace().template room<std::vector<std::uint32_t>>();
    front_.collect(now + traversal.query().limit(), due);
    // It has its new deadline; where that has passed already, the front must go on to say so.
    const bool still_due = first && std::erase(due, witness) > 0;
    const bool enough = traversal.look_at(due.size(), [&](std::size_t i) { return due[i]; });
    if (still_due) front_.leave_rest();
    return enough;
  }

  void stays(std::size_t slot, Seen seen, double gap) {
    front_.expire_at(slot, deadline_of(seen, gap));
  }
  void open(std::size_t slot) { front_.open(slot); }
  std::size_t add(const NodePair& pair, Seen seen, double gap) {
    return front_.add(pair, deadline_of(seen, gap));
  }

  void finish(std::size_t witness, bool enough) {
    if (witness != Outcome::none) front_.bring_forward(witness);
    if (enough) front_.leave_rest();
  }

  /// An entry that has a gap of g to spare costs a test in g / step runs, or in every run. One of
  /// two inner nodes that is opened costs two such entries, whose gaps are wider by about a quarter
  /// of the size of the node opened; one of two leaves, whose triangles are as expensive as
  /// `triangle_cost` volumes, is farther from them by about half of both sizes. And all this does
  /// not pay for itself where gaps last for many runs anyway.
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

  /// A pair of leaves is next looked at when the first of its verdicts can change.
  template <class Query>
  Outcome primitives(Query& query, std::span<const Candidate> pending, Workspace& workspace) {
    if (brief_) return briefly(query, pending);
    auto& verdicts = workspace.room<std::vector<Verdict>>();
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
      // Of two large leaves some at a time: the first deadline counts.
      if (slot != Outcome::none)
        front_.expire_by(slot, least < 0 ? MarginFront::passed : clock_.deadline(least));
      first = i;
    }
    if (outcome.witness != Outcome::none)
      front_.expect(verdicts[outcome.witness].margin < lasting * step_);
    return outcome;
  }

 private:
  static constexpr double lasting = 8;     // runs for which a witness is worth its margin
  static constexpr std::size_t few = 512;  // pairs of triangles that take no long look

  double deadline_of(Seen seen, double gap) const {
    if (seen == Seen::culled) return clock_.deadline(gap);
    return seen == Seen::near ? std::numeric_limits<double>::infinity() : MarginFront::passed;
  }

  template <class Traversal>
  bool look_at_witness(Traversal& traversal, std::uint32_t witness) {
    const NodePair pair = front_[witness];
    if (front_.take_brief_look() && hits_still(traversal, pair, witness)) return true;
    stays(witness, Seen::near, 0);
    traversal.hold(pair, witness);
    return traversal.flush();
  }

  /// Whether a witness that never lasts long is one still, found without its margin, which is as
  /// expensive as ten such looks.
  template <class Traversal>
  bool hits_still(Traversal& traversal, const NodePair& pair, std::uint32_t witness) {
    using Query = typename Traversal::Query;
    if constexpr (Query::one_hit_is_enough && !wants_bound<Query>()) {
      const std::size_t triangles =
          std::size_t{traversal.a().node(pair.a).count} * traversal.b().node(pair.b).count;
      if (triangles > few) return false;
      traversal.hold(pair, witness);
      brief_ = true;
      const bool enough = traversal.flush();
      brief_ = false;
      return enough;
    }
    return false;
  }
  template <class Query>
  Outcome briefly(Query& query, std::span<const Candidate> pending) {
    const Outcome outcome = query.primitives(pending);
    if (outcome.enough) {
      // Known to bodies that stay where they are; when they have moved it is looked at again.
      const Candidate& hit = pending[outcome.witness];
      front_.add_hit(hit.slot, MarginFront::passed, hit.a, hit.b);
    }
    return outcome;
  }

  MarginFront& front_;
  const RelativeMotionBound& clock_;
  double step_;
  bool brief_ = false;  // the witness is looked at without its margin
};

}  // namespace bvlab
