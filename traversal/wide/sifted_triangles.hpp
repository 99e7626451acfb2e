// SPDX-License-Identifier: BSD-3-Clause
/// The leaf stage of wide trees where all hits are sought. A first test culls most pairs of
/// triangles; those left by many leaves are packed into full registers for the filter
/// (contact_batch.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "traversal/wide/contact_batch.hpp"
#include "traversal/wide/filtered_triangles.hpp"

namespace bvlab {

template <class PairFrame, class Body, class Query, class Counter, class Recorder>
class SiftedTriangles : public FilteredTriangles<PairFrame, Body, Query, Counter, Recorder> {
  using Filtered = FilteredTriangles<PairFrame, Body, Query, Counter, Recorder>;
  using Filtered::frame_, Filtered::query_, Filtered::counter_, Filtered::recorder_,
      Filtered::queue_, Filtered::hold, Filtered::put, Filtered::take_held, Filtered::pending_,
      Filtered::at_most;
  using S = typename PairFrame::S;

 public:
  template <class Pair, class Workspace>
  SiftedTriangles(Body& a, Body& b, Pair& pair, Query& query, Counter& counter,
                  Workspace& workspace, Recorder& recorder)
      : Filtered(a, b, pair, query, counter, workspace, recorder),
        sieve_(pair.sieve()),
        batch_(workspace.batch) {
    batch_.clear(), sieve_.begin();
  }

  /// Makes the first test of all queued triangles, and filters the batch if full. Returns whether
  /// the query is satisfied.
  [[gnu::always_inline]] bool test_due() {
    if constexpr (Recorder::measures_gaps)
      for (std::size_t i = 0; i < queue_.size(); ++i)
        recorder_.record_triangles(queue_[i], false, WideFront::none);
    while (!queue_.empty()) {
      frame_.sift(sieve_, queue_, batch_, counter_);
      if (batch_.full() && decide(ContactBatch::Decide::full_registers)) return true;
    }
    return false;
  }
  /// Tests the triangles of an entry: with the others in the queue, unless they are all apart by a
  /// gap that lasts, or their verdicts are to be entries.
  bool test(const OpenPair& pair, std::size_t entry) {
    if (recorder_.is_verdict(entry))
      test_verdict(pair, entry);
    else if (recorder_.sorts(entry))
      sort(pair, entry);
    else if (!recorder_.record_triangles(pair, false, entry) ||
             !recorder_.set_triangle_gap(frame_.triangles(pair), counter_, entry))
      queue_.push(pair, 0);
    return false;
  }
  bool finish() {
    if (held_ == Held::verdicts) find_verdicts();
    return decide(ContactBatch::Decide::all) || Filtered::finish();
  }

 private:
  /// Sorts the pairs of triangles of an entry. Those that are apart by a wide gap in float stay in
  /// it: the least of these gaps is the entry's. The verdict on each of the others becomes an entry
  /// of its own, with its margin: one that is soon due does not make the others due.
  [[gnu::noinline]] void sort(const OpenPair& pair, std::size_t entry) {
    const auto triangles = frame_.triangles(pair);
    const std::uint64_t lanes = triangles.lanes() & recorder_.tested(entry);
    counter_.primitives(static_cast<std::uint64_t>(std::popcount(lanes)));
    const auto gaps = triangle_gaps<S, PairFrame::parts>(triangles, frame_.a_to_b().error_bound());
    std::uint64_t near = 0;
    float least = std::numeric_limits<float>::infinity();
    for_each_part<S, PairFrame::parts>(
        lanes, [&](std::size_t part) __attribute__((always_inline)) {
          near |= bits(!(gaps[part] > S(recorder_.least_useful()))) << (part * S::size());
        });
    for (std::uint64_t rest = lanes & ~near; rest; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      least = std::min(least, float(gaps[lane / S::size()][lane % S::size()]));
    }
    recorder_.set_margin(least, triangles.reference_sphere(), entry);
    for (std::uint64_t rest = lanes & near; rest; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      const NodePair numbers = triangles.numbers(lane);
      test_verdict(numbers, recorder_.add_verdict(numbers, entry, lane));
    }
  }
  /// Tests two triangles whose verdict is an entry; `numbers` are theirs in the trees.
  void test_verdict(const NodePair& numbers, std::size_t entry) {
    if (held_ == Held::open) Filtered::finish();
    held_ = Held::verdicts;
    counter_.primitives(1);
    put(numbers, entry);
    if (pending_ == at_most) find_verdicts();
  }
  /// Finds the verdicts on the held pairs, which are entries, and their margins.
  [[gnu::noinline]] void find_verdicts() {
    const auto held = take_held();
    held_ = Held::open;
    std::array<Verdict, at_most> verdicts;
    query_.primitives(held, std::span(verdicts).first(held.size()));
    for (std::size_t i = 0; i < held.size(); ++i) {
      const double margin = verdicts[i].margin > 0 ? verdicts[i].margin : 0;  // also where it is NaN
      recorder_.set_verdict(held[i].slot, verdicts[i].hit, just_below(margin), {held[i].a, held[i].b},
                            frame_);
    }
  }

  bool hold_open(const NodePair& numbers) {
    if (held_ == Held::verdicts) find_verdicts();
    return hold(numbers);
  }
  [[gnu::noinline]] bool decide(ContactBatch::Decide which) {
    return batch_.template decide<typename Filtered::Lanes>(
        which, frame_.a_to_b().error_bound(),
        [&](std::uint32_t number_a, std::uint32_t number_b, bool meeting) {
          const NodePair numbers{number_a, number_b};
          recorder_.record_touching(numbers);
          if (!meeting) return hold_open(numbers);
          const auto [a, b] = Filtered::in_meshes(numbers);
          return query_.known(a, b);
        });
  }

  typename PairFrame::ContactSieve& sieve_;
  ContactBatch& batch_;
  enum class Held { open, verdicts } held_ = Held::open;  // pairs that the filter left, or entries
};

}  // namespace bvlab
