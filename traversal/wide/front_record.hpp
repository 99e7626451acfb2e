// SPDX-License-Identifier: BSD-3-Clause
/// What a traversal of two trees with stored children records for the next frame: nothing; or a
/// front that is retested whole (a separation list); or a front with gaps, of which only those
/// entries are retested whose gaps may have closed (margins), and the least gap of all. See
/// traversal.hpp for the members of a traversal's recorder.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>

#include "traversal/queries/query.hpp"
#include "traversal/wide/wide_front.hpp"

namespace bvlab {

/// A pair of intersecting triangles that the last traversal found, by their indices in their
/// meshes.
struct Crossing {
  std::uint32_t a, b;
  bool certain;  ///< the filter in float decided it; otherwise the query's own test did
};

/// The expected answer. It affects the order of steps, but no answer.
enum class Expect { touching, apart };

/// Where a traversal starts, given by the memory of its pair of bodies.
struct TraversalStart {
  Expect expect = Expect::touching;
  /// FrontRecord::touched of the last frame. `touched` is queued with the leaves that it is of, for
  /// traversals without a front; `witness` is tested before anything else.
  std::optional<NodePair> touched = {}, witness = {};
  /// Null, or a front: if it is complete the traversal starts from it, else it is written anew.
  WideFront* front = nullptr;
  bool verdicts = false;  ///< where all hits are sought: those on near triangles become entries
  bool rises = false;   ///< of a list: entries are closed again where the bodies have come apart
  double rotation = 0;  ///< sum of the bounds on both bodies' rotations since the first frame
  float step = 0;       ///< about how much nearer the bodies come from frame to frame
};

enum class Keeps { nothing, list, gaps };

/// S is the register of the kernel's lanes.
template <Batched S, Keeps kept>
class FrontRecord {
 public:
  static constexpr Keeps keeps = kept;
  static constexpr bool measures_gaps = kept == Keeps::gaps;

  explicit FrontRecord(const TraversalStart& start)
      : start_(start),
        least_(infinity),
        least_remaining_(infinity),
        sweeps_(keeps_front() && start.front->is_complete()),
        sweep_is_due_(sweeps_ || start.witness) {
    if (keeps_front() && !sweeps_) start_.front->clear();
  }

  template <class Pair>
  void begin(Pair& pair) const {
    if (sweep_is_due_) return;
    pair.start(start_.expect);
    if (start_.touched) pair.retry(*start_.touched);
  }

  /// Whether a front or a witness is to be tested first.
  bool sweep_is_due() const { return sweep_is_due_; }
  /// Tests the witness and retests the entries that are due. Returns whether the query is
  /// satisfied.
  template <class Traversal>
  bool sweep(Traversal& traversal) {
    sweep_is_due_ = false;
    if (start_.witness && traversal.leaves().retest(*start_.witness)) return true;
    if constexpr (kept == Keeps::list)
      if (sweeps_) return sweep_all(traversal);
    if constexpr (kept == Keeps::gaps)
      if (sweeps_) {
        worn_ = find_due(traversal);
        if (!worn_) return sweep_due(traversal);
      }
    if (worn_) start_.front->clear(), start_.front = nullptr, sweeps_ = false;
    traversal.pair().start(start_.expect);
    return false;
  }

  static constexpr std::size_t no_entries() { return WideFront::none; }
  /// The lanes of a step that are tested: of an entry those that are closed, or may rise.
  std::uint64_t tested(std::size_t entry) const {
    if constexpr (kept != Keeps::nothing)
      if (entry != WideFront::none) {
        const WideFront::Entry& at = (*start_.front)[entry];
        return ~std::uint64_t{at.opened} | at.rising;
      }
    return ~std::uint64_t{0};
  }
  /// Records a step: the lanes that are near, and the gap of the others, at its reference sphere.
  /// Returns the near lanes that were not opened before.
  template <class Pair, class Step, class Found, class Query>
  [[gnu::always_inline]] std::uint64_t record(const Pair&, const Step& step, const Found& found,
                                              std::uint64_t near, std::size_t entry, Query&) {
    if constexpr (measures_gaps) least_ = stdx::min(least_, found.least);
    if (!keeps_front()) return near;
    WideFront& front = *start_.front;
    std::uint64_t fresh = near;
    if (entry == WideFront::none) {
      entry = front.add(step.pair, WideFront::Kind::step, near & ~step.of.leaf_lanes());
      if constexpr (measures_gaps) front.gaps().add();
    } else {
      WideFront::Entry& at = front[entry];
      if constexpr (kept == Keeps::list) {
        const std::uint64_t raised = at.rising & found.apart;
        at.opened = static_cast<std::uint16_t>(at.opened & ~raised), at.rising = 0;
        raised_ = raised_ || raised != 0;
      }
      fresh = near & ~std::uint64_t{at.opened};
      grew_ = grew_ || (fresh & ~step.of.leaf_lanes()) != 0;
      at.opened = static_cast<std::uint16_t>(at.opened | (fresh & ~step.of.leaf_lanes()));
    }
    entry_ = static_cast<LaneOfEntry>(entry);
    if constexpr (measures_gaps)
      front.gaps().set(entry, stdx::hmin(found.least), step.of.reference_sphere(),
                       start_.rotation);
    return fresh;
  }
  /// Where the lanes of the step that was recorded last come from (see WorkQueue).
  auto lanes() const {
    if constexpr (kept == Keeps::nothing)
      return NoLanes();
    else
      return LaneOfEntry{16 * entry_};
  }
  /// A pair was opened and then culled, since its volumes are at least `gap` apart: its lane is
  /// closed again.
  template <class Frame>
  void culled(LaneOfEntry from, float gap, const Frame& frame) {
    if (!keeps_front() || from == no_lane) return;
    start_.front->close(from);
    if constexpr (measures_gaps)
      start_.front->gaps().lower_measured(from / 16, gap, frame.a_to_b().error_bound());
  }
  /// Lanes that were opened and not reached are closed again, and due.
  template <class Pair, class Leaves>
  void finish(Pair& pair, const Leaves&, bool) {
    if (!keeps_front()) return;
    for (WorkQueue* open : {&pair.nodes(), &pair.triangles()})
      for (; !open->empty(); open->take_last()) culled(open->last().from, -infinity, pair.frame());
    if (raised_)
      for (std::size_t i = 0; i < start_.front->size(); ++i) drop_if_raised(i);
  }

  /// Records a test of triangles, which are an entry or come from a lane; `touching`: some may
  /// touch. Returns whether to measure their gap.
  bool record_triangles(const OpenPair& pair, bool touching, std::size_t entry) {
    if (touching) touched_ = pair;
    if constexpr (kept == Keeps::nothing) return false;
    if (entry == WideFront::witness) return false;
    if constexpr (measures_gaps) {
      if (!start_.front || entry == WideFront::none) {
        least_ = S(0.0f);
        if (start_.front && pair.from != no_lane) {
          start_.front->add(pair, WideFront::Kind::triangles), start_.front->gaps().add();
          start_.front->open(pair.from);
        }
        return false;
      }
      auto& wait = (*start_.front)[entry].wait;
      if (wait > 0) --wait;
      if (!touching && wait == 0) return true;
      least_ = S(0.0f);
    }
    return false;
  }
  /// Where a distance is sought: records a test of triangles, whose gap and reference sphere are
  /// `found()`.
  template <class Found>
  void record_distances(const OpenPair& pair, std::size_t entry, const Found& found) {
    if constexpr (measures_gaps) {
      if (!start_.front) return;
      if (entry == WideFront::none) {
        entry = start_.front->add(pair, WideFront::Kind::triangles);
        start_.front->gaps().add();
        start_.front->open(pair.from);
      }
      const auto [gap, sphere] = found();
      set_margin(gap, sphere, entry);
    }
  }
  /// Measures the gap of triangles; returns whether it lasts until the next frame.
  template <class Triangles, class Counter>
  bool set_triangle_gap(const Triangles& triangles, Counter& counter, std::size_t entry) {
    const float gap = triangles.gap(counter);
    set_margin(gap, triangles.reference_sphere(), entry);
    const bool lasts = gap > start_.step;
    if (!lasts) (*start_.front)[entry].wait = rest, least_ = stdx::min(least_, S(0.0f));
    return lasts;
  }
  /// The verdicts on the triangles of an entry last until the bodies are nearer by `gap`.
  void set_margin(float gap, const ReferenceSphere& sphere, std::size_t entry) {
    least_ = stdx::min(least_, S(gap));
    start_.front->gaps().set(entry, gap, sphere, start_.rotation);
  }

  // Where all hits are sought:

  bool is_verdict(std::size_t entry) const {
    return (*start_.front)[entry].kind == WideFront::Kind::verdict;
  }
  /// Whether verdicts on the triangles of an entry become entries, or are.
  bool sorts(std::size_t entry) const {
    return (*start_.front)[entry].kind == WideFront::Kind::sorted ||
           (start_.verdicts && !verdicts_worn_);
  }
  /// Pairs of triangles with a smaller gap get entries of their own.
  float least_useful() const { return lasting * start_.step; }
  /// Makes the verdict on two triangles, of a lane of an entry, an entry; returns its number.
  std::size_t add_verdict(const NodePair& numbers, std::size_t entry, int lane) {
    WideFront& front = *start_.front;
    front.sort(entry);
    const LaneOfEntry from = static_cast<LaneOfEntry>(16 * entry) + static_cast<LaneOfEntry>(lane);
    front.open(from);
    front.gaps().add();
    return front.add({numbers, from}, WideFront::Kind::verdict);
  }
  /// Sets the margin of a verdict; `triangles` by their indices in their meshes.
  template <class Frame>
  void set_verdict(std::size_t entry, bool hit, float margin, const NodePair& triangles,
                   const Frame& frame) {
    set_margin(margin, frame.reference_sphere((*start_.front)[entry].pair.a), entry);
    if (entry >= first_new_) {
      ++verdicts_, lasting_verdicts_ += margin > lasting * start_.step;
      verdicts_worn_ = verdicts_worn_ || (verdicts_ >= 16 && 3 * lasting_verdicts_ < verdicts_);
    }
    if (!hit) return;
    touched_ = triangles;
    start_.front->hits.push_back({static_cast<std::uint32_t>(entry), triangles});
  }
  /// Called where all hits are sought, for triangles that touch or may touch, and where a distance
  /// is sought, for those that are nearest so far.
  void record_touching(const NodePair& pair) { touched_ = pair; }
  void record_crossing(const Crossing& found) { crossing_ = found; }

  /// Whether the traversal wrote a front or updated one.
  bool keeps_front() const { return kept != Keeps::nothing && start_.front; }
  /// Whether the traversal started from the front.
  bool sweeps() const { return sweeps_; }
  /// Of a list: pairs of volumes tested; and whether a lane of an old entry was opened.
  void count(std::size_t tests) { tests_ += tests; }
  std::size_t tests() const { return tests_; }
  bool grew() const { return grew_; }
  /// Whether verdicts are not worth being entries: most new ones do not last, or so many are due
  /// that testing whole leaves costs less.
  bool verdicts_worn() const { return verdicts_worn_; }
  bool has_verdicts() const { return keeps_front() && start_.front->sorted() > 0; }
  /// Whether so many entries were due that the traversal left the front and started from the roots.
  bool worn() const { return worn_; }
  const std::optional<Crossing>& crossing() const { return crossing_; }
  /// The pair whose triangles touched, or may have.
  const std::optional<NodePair>& touched() const { return touched_; }
  /// A lower bound on how far the bodies can come nearer before the answer may change; 0 where none
  /// is known, and where it overflowed: an infinite gap would last for ever. It covers the rounding
  /// of separations (see slab_box_sibling_test.hpp, gaps).
  double gap() const {
    const double least = std::min(stdx::hmin(least_), stdx::hmin(least_remaining_));
    return least > 0 && least < infinity ? least * (1 - 32 * unit_roundoff<float>) : 0;
  }

 private:
  using Gaps = MeasuredGaps::S;
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  /// Triangles whose gap was too small to last are tested so many times before it is measured
  /// again.
  static constexpr std::uint8_t rest = 8;
  /// A front wears out where retesting it costs more than this share of a traversal from the roots:
  /// the saved tests must also pay for writing fronts.
  static constexpr float most_of_rebuild = 0.75f;
  static constexpr float lasting = 4;  // frames
  /// Due verdicts that cost less than testing whole leaves, beside one for each pair of leaves.
  static constexpr std::size_t few_verdicts = 16;

  void drop_if_raised(std::size_t i) {
    const WideFront::Entry& at = (*start_.front)[i];
    if (at.kind != WideFront::Kind::gone && at.from != no_lane && !start_.front->is_open(at.from))
      start_.front->drop(i);
  }

  /// Retests all entries of a list.
  template <class Traversal>
  bool sweep_all(Traversal& traversal) {
    WideFront& front = *start_.front;
    const std::size_t size = front.size();  // added entries are not retested
    for (std::size_t i = 0; i < size; ++i) {
      if (raised_) drop_if_raised(i);
      if (front[i].kind == WideFront::Kind::gone) continue;
      traversal.pair().visit(traversal, {front[i].pair, front[i].from}, i);
      if (start_.rises) front.propose(i);
      if (traversal.leaves().test_due()) return true;
    }
    return false;
  }
  /// Finds the entries that are due, that is, may have come within the query's limit. Returns
  /// whether the front has worn out.
  template <class Traversal>
  bool find_due(Traversal& traversal) {
    const Gaps limit(rounded_up<float>(traversal.query().limit()));
    WideFront& front = *start_.front;
    auto& due = traversal.workspace().due;
    due.clear();
    first_new_ = front.size();
    float cost = 0;
    std::size_t verdicts = 0;
    for (std::size_t first = 0; first < front.size(); first += MeasuredGaps::width) {
      std::uint64_t lanes = due_lanes(front, first, limit, traversal.pair().frame().a_to_b());
      due.push_back(lanes);
      for (; lanes; lanes &= lanes - 1) {
        const auto kind = front[first + static_cast<std::size_t>(std::countr_zero(lanes))].kind;
        cost += WideFront::cost(kind), verdicts += kind == WideFront::Kind::verdict;
      }
    }
    const bool wears = cost > most_of_rebuild * front.cost_of_rebuild();
    // Verdicts go before the front does.
    verdicts_worn_ = verdicts > front.sorted() + few_verdicts || (wears && front.sorted() > 0);
    return wears && !verdicts_worn_;
  }
  [[gnu::always_inline]] std::uint64_t due_lanes(const WideFront& front, std::size_t first,
                                                 const Gaps& limit,
                                                 const CornerTransform& corners) {
    const Gaps remaining = front.gaps().remaining(first, corners, start_.rotation) - limit;
    const std::size_t lanes = std::min<std::size_t>(front.size() - first, MeasuredGaps::width);
    const auto lasts = remaining > Gaps(0.0f);
    stdx::where(lasts, least_remaining_) = stdx::min(least_remaining_, remaining);
    return ~bits(lasts) & ((std::uint64_t{1} << lanes) - 1);
  }
  template <class Traversal>
  bool sweep_due(Traversal& traversal) {
    using Query = typename Traversal::Query;
    WideFront& front = *start_.front;
    const auto& due = traversal.workspace().due;
    if constexpr (FindsAllHits<Query>) repeat_hits(traversal.query(), due);
    for (std::size_t k = 0; k < due.size(); ++k)
      for (std::uint64_t rest = due[k]; rest; rest &= rest - 1) {
        const std::size_t i = k * MeasuredGaps::width +
                              static_cast<std::size_t>(std::countr_zero(rest));
        const OpenPair pair{front[i].pair, front[i].from};
        if (front[i].kind == WideFront::Kind::step)
          traversal.pair().visit(traversal, pair, i);
        else if (traversal.leaves().test(pair, i))
          return true;
      }
    return traversal.leaves().test_due();
  }
  /// Passes the hits of entries that are not due to the query, and drops the others.
  template <class Query>
  void repeat_hits(Query& query, const std::vector<std::uint64_t>& due) {
    std::erase_if(start_.front->hits, [&](const WideFront::Hit& hit) {
      if (due[hit.entry / MeasuredGaps::width] >> hit.entry % MeasuredGaps::width & 1) return true;
      query.known(hit.triangles.a, hit.triangles.b);
      return false;
    });
  }

  TraversalStart start_;
  S least_;
  Gaps least_remaining_;
  std::optional<NodePair> touched_;
  std::optional<Crossing> crossing_;
  LaneOfEntry entry_ = 0;  // that was recorded last
  std::size_t tests_ = 0, verdicts_ = 0, lasting_verdicts_ = 0;  // verdicts: new ones
  std::size_t first_new_ = 0;  // entries from here on were made in this run
  bool grew_ = false, verdicts_worn_ = false;
  bool sweeps_, sweep_is_due_, worn_ = false;
  bool raised_ = false;  // a lane was closed whose entry may still be there
};

}  // namespace bvlab
