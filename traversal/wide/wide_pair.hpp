// SPDX-License-Identifier: BSD-3-Clause
/// Two bodies over wide trees as the loop sees them (traversal.hpp), by any kernel that tests all
/// lanes of a step in registers (siblings_kernel.hpp, mixed_kernel.hpp). An open pair, and an entry
/// of a front that is not of triangles, is the pair of nodes of one step.
///
/// If a distance is sought, and in the first steps where one hit is expected, the open pair that is
/// likeliest to end the search is taken first (see WorkQueue); else the last ones, four at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "hierarchies/wide/lanes.hpp"
#include "traversal/traversal.hpp"
#include "traversal/wide/contact_batch.hpp"
#include "traversal/wide/filtered_triangles.hpp"
#include "traversal/wide/front_record.hpp"
#include "traversal/wide/sifted_triangles.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

/// Buffers that are reused from one traversal to the next.
struct WideWorkspace {
  WorkQueue nodes;      ///< pairs of nodes
  WorkQueue triangles;  ///< pairs whose triangles are to be tested
  ContactBatch batch;   ///< pairs of triangles that may touch, where all hits are sought
  std::vector<std::uint64_t> due;  ///< of a front, for each register of entries those that are due
};

template <class V, int F, class Kernel>
class WidePair {
 public:
  using PairFrame = typename Kernel::template PairFrame<V, F>;
  using Workspace = WideWorkspace;
  using Body = typename Kernel::template Body<V, F>;
  template <class Query, class Counter, class Recorder>
  using Leaves = std::conditional_t<FindsAllHits<Query>,
                                    SiftedTriangles<PairFrame, Body, Query, Counter, Recorder>,
                                    FilteredTriangles<PairFrame, Body, Query, Counter, Recorder>>;
  static_assert(std::is_same_v<typename V::scalar, float>,
                "orders and the filter of triangles are float32");

  WidePair(Body& a, Body& b, Workspace& workspace)
      : nodes_(workspace.nodes), triangles_(workspace.triangles) {
    frame_.begin(a, b);
    nodes_.clear(), triangles_.clear();
  }

  /// Starts from the roots.
  void start(Expect expect) {
    steps_ = expect == Expect::touching ? 0 : most_in_order + 1;
    nodes_.push(frame_.roots(), 0);
  }
  /// The pair that touched in the last frame, tested first.
  void retry(const NodePair& touched) { frame_.retry(touched, nodes_, triangles_); }

  const PairFrame& frame() const { return frame_; }
  /// The open pairs of nodes, and those whose triangles wait for a test.
  WorkQueue& nodes() { return nodes_; }
  WorkQueue& triangles() { return triangles_; }
  /// The first test of triangles where all hits are sought; it keeps a leaf of a, transformed.
  typename PairFrame::ContactSieve& sieve() { return sieve_; }
  bool done() const { return nodes_.empty(); }

  template <class Traversal>
  [[gnu::always_inline]] void next(Traversal& traversal) {
    using Query = typename Traversal::Query;
    if constexpr (Traversal::wanted == TestFor::bound) {
      if (nodes_.empty()) return;  // a front was retested, and nothing is near
      float order;
      const OpenPair pair = nodes_.take_least(order);
      // Where it is positive, `order` is a lower bound on the distance of the pair.
      if (order > 0 && bits(traversal.query().culls(order)))
        traversal.recorder().culled(pair.from, order, frame_);
      else
        visit(traversal, pair, traversal.recorder().no_entries());
    } else {
      std::array<OpenPair, at_once> taken;
      const std::size_t count = take<Query>(taken);
      for (std::size_t k = 0; k < count; ++k)
        visit(traversal, taken[k], traversal.recorder().no_entries());
    }
  }

  /// A kernel's step and the pair that it is the step of.
  template <class KernelStep>
  struct Step {
    const KernelStep& of;
    OpenPair pair;

    std::uint64_t lanes() const { return of.lanes(); }
  };

  /// Has the kernel make the step of a pair, and visits it.
  template <class Traversal>
  [[gnu::always_inline]] void visit(Traversal& traversal, const OpenPair& pair, std::size_t entry) {
    const auto named = [&]<class KernelStep>(const KernelStep& step)
        __attribute__((always_inline)) {
      traversal.visit(Step<KernelStep>{step, pair}, entry);
    };
    if constexpr (FindsAllHits<typename Traversal::Query>) {
      frame_.step(pair, traversal.counter(), sieve_, named);
    } else {
      struct {
      } no_sieve;
      frame_.step(pair, traversal.counter(), no_sieve, named);
    }
  }

  /// What a step has found, lane by lane.
  struct Found : LanesApart {
    using S = typename PairFrame::S;
    std::array<S, PairFrame::parts> order;  ///< of lanes: the least may end a search
    S least;  ///< the least gap of lanes that are apart, where gaps are measured
  };

  template <TestFor wanted, class Step, class Query, class Counter>
  [[gnu::always_inline]] Found test(const Step& step, Query& query, Counter&) const {
    using S = typename Found::S;
    Found found;
    found.apart = 0, found.least = S(std::numeric_limits<float>::infinity());
    for_each_part<S, PairFrame::parts>(
        step.lanes(), [&](std::size_t part) __attribute__((always_inline)) {
          found.apart |= test_part<wanted>(step.of, query, part, found) << (part * S::size());
        });
    return found;
  }

  template <class Step, class Entry, class Recorder, class Leaves, class Query, class Counter>
  [[gnu::always_inline]] void pass_on(const Step& step, const Found& found, std::uint64_t lanes,
                                      Entry, Recorder& recorder, Leaves&, Query&, Counter&) {
    constexpr bool ordered = Kernel::nearest_child_first && DecidedByOneHit<Query>;
    if constexpr (FindsAllHits<Query>)
      step.of.push(nodes_, triangles_, lanes, NoOrder(), NextPair::any, recorder.lanes());
    else
      step.of.push(nodes_, triangles_, lanes, found.order,
                   ordered && steps_ <= most_in_order ? NextPair::nearest_child : NextPair::any,
                   recorder.lanes());
  }

 private:
  /// A hit takes 5 to 13 steps. After more, the bodies are likely apart, and then the order is
  /// irrelevant: steps that do not wait for one another take half the time.
  static constexpr int most_in_order = 16;
  static constexpr std::size_t at_once = 4;

  /// Takes the pairs that are visited next: one where the order matters; returns how many.
  template <class Query>
  [[gnu::always_inline]] std::size_t take(std::array<OpenPair, at_once>& taken) {
    if constexpr (!FindsAllHits<Query>) {
      if (!triangles_.empty()) return 0;  // those of the pair that touched come first
      if (++steps_ <= most_in_order) {
        float order;
        taken[0] = Kernel::nearest_child_first ? nodes_.take_last() : nodes_.take_least(order);
        return 1;
      }
    }
    const std::size_t count = std::min(nodes_.size(), at_once);
    for (std::size_t k = 0; k < count; ++k) taken[k] = nodes_.take_last();
    if constexpr (FindsAllHits<Query>)
      for (std::size_t k = 1; k < count; ++k) frame_.prefetch(taken[k]);
    return count;
  }

  template <TestFor wanted, class Step, class Query>
  [[gnu::always_inline]] static std::uint64_t test_part(const Step& step, Query& query,
                                                        std::size_t part, Found& found) {
    using S = typename Found::S;
    if constexpr (wanted == TestFor::bound) {
      found.order[part] = step.gaps(part);
      const auto culled = query.culls(found.order[part]);
      stdx::where(culled, found.least) = stdx::min(found.least, found.order[part]);
      return bits(culled);
    } else if constexpr (wanted == TestFor::margins) {
      const auto seen = step.separation(part);
      found.order[part] = seen.order;
      const auto apart = seen.gap > S(0.0f);
      // Lanes without a child repeat one.
      stdx::where(apart, found.least) = stdx::min(found.least, seen.gap);
      return bits(apart);
    } else {
      const auto seen = step.overlap(part);
      found.order[part] = seen.order;
      return bits(seen.apart);
    }
  }

  PairFrame frame_;
  typename PairFrame::ContactSieve sieve_;
  WorkQueue& nodes_;
  WorkQueue& triangles_;
  int steps_ = most_in_order + 1;
};

}  // namespace bvlab
