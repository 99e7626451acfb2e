// SPDX-License-Identifier: BSD-3-Clause
/// The leaf stage of wide trees where all hits are sought. A first test culls most pairs of
/// triangles; those left by many leaves are packed into full registers for the filter
/// (contact_batch.hpp).
#pragma once

#include <cstdint>

#include "traversal/wide/contact_batch.hpp"
#include "traversal/wide/filtered_triangles.hpp"

namespace bvlab {

template <class PairFrame, class Body, class Query, class Counter, class Recorder>
class SiftedTriangles : public FilteredTriangles<PairFrame, Body, Query, Counter, Recorder> {
  using Filtered = FilteredTriangles<PairFrame, Body, Query, Counter, Recorder>;
  using Filtered::frame_, Filtered::query_, Filtered::counter_, Filtered::recorder_,
      Filtered::queue_, Filtered::hold;

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
        recorder_.record_triangles(queue_[i], false, Recorder::no_entries());
    while (!queue_.empty()) {
      frame_.sift(sieve_, queue_, batch_, counter_);
      if (batch_.full() && decide(ContactBatch::Decide::full_registers)) return true;
    }
    return false;
  }
  bool finish() { return decide(ContactBatch::Decide::all) || Filtered::finish(); }

 private:
  [[gnu::noinline]] bool decide(ContactBatch::Decide which) {
    return batch_.template decide<typename Filtered::Lanes>(
        which, frame_.a_to_b().error_bound(),
        [&](std::uint32_t number_a, std::uint32_t number_b, bool meeting) {
          const std::uint32_t a = frame_.triangle(0, number_a), b = frame_.triangle(1, number_b);
          recorder_.record_touching({number_a, number_b});
          return meeting ? query_.known(a, b) : hold(a, b);
        });
  }

  typename PairFrame::ContactSieve& sieve_;
  ContactBatch& batch_;
};

}  // namespace bvlab
