// SPDX-License-Identifier: BSD-3-Clause
/// The loop over two hierarchies, for every kernel, query and recorder.
///
/// A step takes pairs of nodes, tests their volumes in the lanes of registers, has the recorder
/// record what is apart, and passes the rest on: pairs of leaves to the leaf stage, which tests
/// their triangles; of all others, the gathered kernel queues the pairs of their children, and the
/// wide kernels, which tested children, queue the pairs themselves. A traversal from the two roots
/// is the recursive algorithm. From a front, the steps of its entries come first.
///
/// The parts. GatheredPair goes with FrontRecorder, WidePair with FrontRecord:
///   the pair      two bodies as a kernel sees them, and the open pairs: what a step tests, and
///                 what comes next (GatheredPair, WidePair)
///   the recorder  what a run keeps of tested pairs: nothing, a list, or a front with gaps
///   the leaves    the pair's leaf stage (HeldPrimitives; FilteredTriangles or SiftedTriangles)
///
/// Members of a pair. The lanes of a step are bits of a mask.
///   done()                            whether no pair is open
///   next(traversal)                   calls traversal.visit(step, entries) for the next step, for
///                                     several, or for none
///   visit(traversal, pair, entry)     the same for an entry of a front (WidePair alone)
///   test<wanted>(step, query, counter)    what is apart: a LanesApart, or more in a derived class
///   pass_on(step, found, lanes, entries, recorder, leaves, query, counter)
///                                     queues what a step has found near
/// Members of a recorder:
///   measures_gaps                     whether steps measure gaps for it
///   begin(pair)                       queues the first pairs, unless sweep() does that
///   no_entries()                      what `entries` is for a step whose pairs are not yet entries
///   sweep_is_due(), sweep(traversal)  whether entries of a front come first; tests them, and
///                                     returns whether the query is satisfied
///   tested(entries)                   the lanes of a step that are tested, where not all are
///   record(pair, step, found, near, entries, query)
///                                     records what is apart; `near`: the other lanes. Returns the
///                                     lanes to pass on. `entries`: the entries that are tested
///   finish(pair, leaves, satisfied)   the run is over
/// Members of the leaves:
///   test_due(), finish()              test triangles that need not wait any longer, or all; return
///                                     whether the query is satisfied
///   tested()                          pairs of triangles tested so far; called by run() alone, as
///                                     posed() of a pair is
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "traversal/queries/query.hpp"
#include "traversal/tracked_front.hpp"

namespace bvlab {

/// What a test of two volumes is for: whether they overlap; for margins, also a lower bound on
/// their distance; or a lower bound by which the query culls.
enum class TestFor { overlap, margins, bound };

/// The lanes of a step whose volumes are apart, or which the query culls.
struct LanesApart {
  std::uint64_t apart;
};

/// One run, made in one go or step by step, so that a caller can interleave several pairs of
/// bodies: while one waits for a result, another is computed.
template <class PairType, class QueryType, class Counter, class Recorder>
class Traversal {
 public:
  using Pair = PairType;
  using Query = QueryType;
  using Leaves = typename Pair::template Leaves<Query, Counter, Recorder>;
  static constexpr TestFor wanted = wants_bound<Query>()      ? TestFor::bound
                                    : Recorder::measures_gaps ? TestFor::margins
                                                              : TestFor::overlap;

  /// The recorder is constructed from `start`; a FrontRecorder refers to it. All must outlive this.
  /// `of_pair` is what a pair takes beside the bodies.
  template <class Body, class Start, class... OfPair>
  Traversal(Body& a, Body& b, Query& query, Counter& counter, typename Pair::Workspace& workspace,
            Start&& start, const OfPair&... of_pair)
      : query_(query),
        counter_(counter),
        workspace_(workspace),
        recorder_(start),
        pair_(a, b, workspace, of_pair...),
        leaves_(a, b, pair_, query, counter, workspace, recorder_) {
    recorder_.begin(pair_);
  }
  Traversal(const Traversal&) = delete;
  Traversal& operator=(const Traversal&) = delete;

  /// Sweeps the front, or tests what comes next; returns whether there is more to do.
  [[gnu::noinline]] bool advance() { return step(); }
  /// Calls advance until the run is over. Not for wide trees, whose leaves have no tested().
  [[gnu::always_inline]] TraversalStatistics run() {
    while (step()) {
    }
    return {!satisfied_, tests_, leaves_.tested(), pair_.posed(tests_)};
  }

  /// Tests a step's volumes and passes on what is near. Always inlined: what it finds stays in
  /// registers.
  template <class Step, class Entries>
  [[gnu::always_inline]] void visit(Step&& step, const Entries& entries) {
    const std::uint64_t lanes = step.lanes() & recorder_.tested(entries);
    count_tests(static_cast<std::size_t>(std::popcount(lanes)));
    const auto found = pair_.template test<wanted>(step, query_, counter_);
    const std::uint64_t near =
        recorder_.record(pair_, step, found, lanes & ~found.apart, entries, query_);
    pair_.pass_on(step, found, near, entries, recorder_, leaves_, query_, counter_);
  }

  /// Visits what the kernel takes next; returns whether the query is satisfied.
  bool next() {
    pair_.next(*this);
    return leaves_.test_due();
  }

  void count_tests(std::size_t count) {
    // For run() alone.
    if constexpr (requires(const Leaves& leaves) { leaves.tested(); }) tests_ += count;
    if constexpr (requires { recorder_.count(count); }) recorder_.count(count);
    counter_.tested(count);
  }

  Pair& pair() { return pair_; }
  Query& query() const { return query_; }
  Counter& counter() const { return counter_; }
  typename Pair::Workspace& workspace() const { return workspace_; }
  Recorder& recorder() { return recorder_; }
  Leaves& leaves() { return leaves_; }

 private:
  [[gnu::always_inline]] bool step() {
    satisfied_ = recorder_.sweep_is_due() ? recorder_.sweep(*this) : next();
    if (!satisfied_ && !pair_.done()) return true;
    satisfied_ = satisfied_ || leaves_.finish();
    recorder_.finish(pair_, leaves_, satisfied_);
    return false;
  }

  Query& query_;
  Counter& counter_;
  typename Pair::Workspace& workspace_;
  [[no_unique_address]] Recorder recorder_;
  Pair pair_;
  Leaves leaves_;
  std::size_t tests_ = 0;
  bool satisfied_ = false;
};

}  // namespace bvlab
