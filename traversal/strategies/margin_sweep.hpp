// SPDX-License-Identifier: BSD-3-Clause
/// One run from a front with margins: tests the entries that are due, measures their gaps anew, and
/// opens culled pairs with small gaps into pairs with wider ones. A run that does not measure
/// (measuring_rule.hpp) only tests, and the entries it has tested are due again in the next run.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "traversal/queries/query.hpp"
#include "traversal/strategies/margin_front.hpp"
#include "traversal/strategies/measuring_rule.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

class MarginSweep : public FrontDefaults {
 public:
  static constexpr bool measures_gaps = true;
  static constexpr std::size_t held_at_least = 7;  // margins are measured for a batch at once

  /// `step`: about how much nearer the bodies come from run to run. `front`, `now` and `rule` must
  /// outlive this.
  MarginSweep(MarginFront& front, PresentPoses& now, MeasuringRule& rule, double step)
      : front_(front), now_(now), rule_(rule), step_(step) {}

  const NodePair& operator[](std::size_t slot) const { return front_[slot]; }
  bool witnessed() const { return front_.witnessed(); }

  /// Tests the due entries, the witness first if it is one of them or the query wants a bound.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    using Query = typename Traversal::Query;
    spheres_ = {traversal.a().node_spheres(), traversal.b().node_spheres()};
    children_ =
        std::max({children_, traversal.a().node(0).children, traversal.b().node(0).children});
    // Distances need these bounds anyway.
    constexpr bool always_measures = wants_bound<Query>();
    measures_ = always_measures || rule_.expected();
    const std::uint32_t witness = front_.witness();
    const bool first = !FindsAllHits<Query> && front_.witnessed() &&
                       (wants_bound<Query>() || front_.is_due(witness, now_));
    if (first) {
      if (test_witness(traversal, witness)) return true;
      measure();
    }
    auto& buffer = traversal.workspace().template scratch<std::vector<std::uint32_t>>();
    const MarginFront::Due due = front_.collect(now_, traversal.query().limit(), buffer);
    lower_least(due.least_of_others);
    if constexpr (!always_measures) measures_ = rule_.decide(due.slots.size(), front_.size());
    if constexpr (FindsAllHits<Query>) {
      front_.remove_hits_of_due();
      for (const KnownHit& hit : front_.hits()) traversal.query().known(hit.a, hit.b);
    }
    std::size_t count = due.slots.size();
    if (first)  // it has been tested
      count -= std::ranges::remove(due.slots, witness).size();
    return traversal.test_entries(count, [&](std::size_t i) { return due.slots[i]; });
  }
  /// After a complete run, a lower bound on what is left of every gap; after one that a hit ended,
  /// the margin of that hit. Not positive where it is not known.
  float least() const { return least_; }
  /// About how many entries opening culled pairs has added: each is replaced by as many as a root
  /// has children.
  std::size_t entries_added() const { return opened_ * (children_ - 1); }
  /// Whether margins were measured. If not, the front does not have all hits of the run.
  bool measures() const { return measures_; }

  void keep(std::size_t slot, EntryState state, double gap) {
    if (!measures_) {  // collect(), add() or test_witness() has forgotten the gap
      least_ = 0;
      return;
    }
    switch (state) {
      case EntryState::culled:
        return front_.announce_gap(slot, just_below(gap));
      case EntryState::near:
        return front_.announce_triangles(slot);
      case EntryState::not_yet:
        front_.forget_gap(slot);
        least_ = 0;
    }
  }
  void open(std::size_t slot) { front_.open(slot); }
  std::size_t add(const NodePair& pair, EntryState state, double gap) {
    const std::size_t slot = front_.add(pair);
    keep(slot, state, gap);
    return slot;
  }

  void finish(std::size_t witness, bool satisfied) {
    if (witness != Outcome::none) front_.set_witness(witness);
    rule_.add_announced(front_.announced());
    measure();
    if (satisfied) least_ = margin_of_hit_;
  }

  /// Whether opening a culled pair saves tests. An entry with a spare gap of g costs one test in
  /// every g / step-th run, or in every run. A pair with an inner node, opened, becomes about two
  /// such entries (more in wide trees), with gaps wider by about a tenth of the size of the opened
  /// node. A pair of leaves, whose triangles cost as much as `triangle_cost` volumes, has triangles
  /// farther apart by about half of both sizes. Where gaps last for many runs anyway, opening does
  /// not pay.
  ///
  /// Why a tenth: with .25 bunnies take as long, but where large triangles meet small ones
  /// (published planning problems) fronts are up to ten times as long, and runs take up to four
  /// times as long. With .05 slow bodies take longer.
  template <class Query, class Node>
  bool opens(const Query& query, const Node& a, const Node& b, double gap) {
    if (!measures_) return false;
    constexpr double triangle_cost = 3, leaf_gain = 0.5, inner_gain = 0.1, long_enough = 4;
    const double spare = gap - query.limit();
    const auto opened = descent(a, b) == Descent::a ? a.size : b.size;  // not used of two leaves
    // Chosen by index: a branch would be mispredicted.
    const std::size_t both_leaves = (a.count != 0) & (b.count != 0);
    const std::array<double, 2> size{static_cast<double>(opened),
                                     static_cast<double>(a.size + b.size)};
    constexpr std::array gain{inner_gain, leaf_gain}, costs{2.0, 1 + triangle_cost};
    const double wider = gain[both_leaves] * size[both_leaves], cost = costs[both_leaves];
    const bool opens =
        (spare < long_enough * step_) & (cost * std::max(spare, step_) < spare + wider);
    opened_ += std::size_t{opens} & ~both_leaves;
    return opens;
  }

  /// A pair of leaves is due when the first of its verdicts may change.
  template <class Query>
  Outcome primitives(Query& query, std::span<const Candidate> pending, Workspace& workspace) {
    if (brief_ || !measures_) return briefly(query, pending);
    auto& verdicts = workspace.scratch<std::vector<Verdict>>();
    verdicts.assign(pending.size(), {});
    const Outcome outcome = query.primitives(pending, verdicts);
    for (std::size_t first = 0; first < pending.size();) {
      const std::size_t slot = pending[first].slot;
      double least = std::numeric_limits<double>::infinity();
      std::size_t i = first;
      for (; i < pending.size() && pending[i].slot == slot; ++i) {
        const double margin = verdicts[i].margin;
        least = margin > 0 ? std::min(least, margin) : 0;  // also where it is NaN
        if (verdicts[i].hit && slot != Outcome::none) {
          add_hit<Query>(pending[i], margin);
          if constexpr (!FindsAllHits<Query>)
            if (outcome.satisfied && i == outcome.witness)
              front_.repeat_hit(front_.hits().size() - 1);
        }
      }
      // Two large leaves are tested in several portions: the least margin counts.
      if (slot != Outcome::none) front_.lower_gap(slot, just_below(least));
      first = i;
    }
    if (outcome.witness != Outcome::none) {
      const double margin = verdicts[outcome.witness].margin;
      if (outcome.satisfied) margin_of_hit_ = just_below(margin);
      front_.expect(margin < lasting * step_);
    }
    return outcome;
  }

 private:
  static constexpr double least_useful = 0.5;  // steps; a smaller gap is used up by the next run
  static constexpr double lasting = 8;         // runs for which measuring a witness's margin pays
  static constexpr std::size_t few = 512;      // pairs of triangles that are quickly tested

  ReferenceSphere reference_sphere(const NodePair& pair) {
    return reference_sphere_of_smaller(spheres_[0][pair.a], spheres_[1][pair.b], now_.transforms());
  }
  void measure() { lower_least(front_.measure(now_, spheres_, just_below(least_useful * step_))); }
  /// NaN counts as 0.
  void lower_least(float gap) { least_ = gap > 0 ? std::min(least_, gap) : 0; }
  template <class Query>
  void add_hit(const Candidate& candidate, double margin) {
    const KnownHit hit{static_cast<std::uint32_t>(candidate.slot), candidate.a, candidate.b};
    if constexpr (FindsAllHits<Query>)
      front_.add_hit(hit);
    else if (!(margin > 0))
      front_.add_brief_hit(hit);
    else
      front_.add_hit(hit, just_below(margin), reference_sphere(front_[hit.slot]), now_.rotation());
  }

  template <class Traversal>
  bool test_witness(Traversal& traversal, std::uint32_t witness) {
    const NodePair pair = front_[witness];
    if (measures_ && front_.take_brief_test() && hits_still(traversal, pair, witness)) return true;
    front_.forget_gap(witness);
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
    if (outcome.satisfied && outcome.witness != Outcome::none) {
      // Valid while the bodies do not move, if this run measures; else it is tested again.
      add_hit<Query>(pending[outcome.witness], 0);
      margin_of_hit_ = 0;
    }
    return outcome;
  }

  MarginFront& front_;
  PresentPoses& now_;
  MeasuringRule& rule_;
  std::array<const NodeSphere*, 2> spheres_{};
  double step_;
  std::size_t opened_ = 0;  // culled pairs with an inner node
  std::uint32_t children_ = 2;
  bool measures_ = true;
  float least_ = std::numeric_limits<float>::infinity();
  float margin_of_hit_ = 0;
  bool brief_ = false;  // the witness is tested without its margin
};

}  // namespace bvlab
