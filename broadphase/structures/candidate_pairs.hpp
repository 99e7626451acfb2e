// SPDX-License-Identifier: BSD-3-Clause
/// Candidate pairs, and the test of which overlap. Boxes are held in slots, as rows. Each frame
/// compares every candidate, under two nanoseconds each in the cache, and writes the list anew.
///
/// 8 bytes per candidate; where changes are reported one more, or nine on several threads.
#pragma once

#include <vector>

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/row.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

template <class T, class Contact>
class CandidatePairs {
 public:
  /// Removes all candidates; rows are kept.
  void clear() {
    candidates_.clear();
    hits_known_ = false;
  }
  std::size_t size() const { return candidates_.size(); }
  /// Pairs of slots, the one whose box has the smaller index in the frame first. May be written to
  /// until the next comparison.
  PairList& list() { return candidates_; }

  LargeVector<Row<T>>& rows() { return rows_; }
  const LargeVector<Row<T>>& rows() const { return rows_; }

  /// Adds a candidate: slots `a` and `b` with their box indices. It must not be in the list yet.
  void add(std::uint32_t a, std::uint32_t id_a, std::uint32_t b, std::uint32_t id_b) {
    candidates_.push(id_a < id_b ? Pair{a, b} : Pair{b, a});
    if (hits_known_) hits_.push_back(0);
  }

  /// Compares all candidates and writes those that overlap to `list`; `ids` maps a slot to its box.
  /// From the second call on, appends the changes since the last call to `began` and `ended`.
  void compare_all(const std::uint32_t* ids, PairList& list, PairList& began, PairList& ended) {
    const std::size_t count = candidates_.size();
    list.clear();
    hits_.resize(count);
    Pair* const to = list.reserve(count + 1);
    list.set_end(to + compare_keeping(ids, 0, count, to, began, ended));
    hits_known_ = true;
  }

  /// The same by several threads, with the same lists in the same order: each stretch of candidates
  /// is compared into its own buffer, and the buffers are concatenated.
  void compare_all_shared(const std::uint32_t* ids, PairList& list, PairList& began,
                          PairList& ended, Threads& threads) {
    const std::size_t count = candidates_.size();
    constexpr std::size_t stretch = 1024;
    hits_.resize(count);
    found_pairs_.resize(count);
    found_.resize((count + stretch - 1) / stretch);
    threads.share(found_.size(), [&](std::size_t k, std::size_t) {
      Found& found = found_[k];
      const std::size_t first = k * stretch;
      found.began.clear(), found.ended.clear();
      found.count = compare_keeping(ids, first, std::min(first + stretch, count),
                                    found_pairs_.data() + first, found.began, found.ended);
    });
    std::size_t sum = 0;
    for (Found& found : found_) {
      found.first = sum, sum += found.count;
      began.append(found.began.view()), ended.append(found.ended.view());
    }
    list.clear();
    Pair* const pairs = list.reserve_shared(sum);
    threads.share(found_.size(), [&](std::size_t k, std::size_t) {
      std::copy_n(found_pairs_.data() + k * stretch, found_[k].count, pairs + found_[k].first);
    });
    list.set_end(pairs + sum);
    hits_known_ = true;
  }

  /// Compares the candidates from `first` to `last` only and appends to the list; keeps no record.
  void compare_range(const std::uint32_t* ids, PairList& list, std::size_t first,
                     std::size_t last) const {
    const Row<T>* rows = rows_.data();
    // In stretches, since only the pages that pairs are written to should be brought in.
    constexpr std::size_t stretch = 4096;
    for (; first < last; first += stretch) {
      const std::size_t count = std::min(stretch, last - first);
      Pair* out = list.reserve(count + 1);
      for (const Pair& c : candidates_.view().subspan(first, count)) {
        *out = {ids[c.i], ids[c.j]};
        out += overlap<Contact>(rows[c.i], rows[c.j]);
      }
      list.set_end(out);
    }
  }

 private:
  /// Compares the candidates from `first` to `last` and writes overlapping pairs to `pairs`;
  /// returns their number.
  std::size_t compare_keeping(const std::uint32_t* ids, std::size_t first, std::size_t last,
                              Pair* pairs, PairList& began, PairList& ended) {
    std::size_t found = 0;
    for (std::size_t c = first; c < last; ++c) {
      const Pair candidate = candidates_[c];
      const Pair pair{ids[candidate.i], ids[candidate.j]};
      const bool hit = overlap<Contact>(rows_[candidate.i], rows_[candidate.j]);
      if (hits_known_ && hit != static_cast<bool>(hits_[c])) (hit ? began : ended).push(pair);
      hits_[c] = hit;
      pairs[found] = pair;
      found += hit;
    }
    return found;
  }

  /// What one thread found in a stretch of candidates.
  struct Found {
    std::size_t first, count;  ///< of the list
    PairList began, ended;
  };

  LargeVector<Row<T>> rows_;
  PairList candidates_;
  bool hits_known_ = false;
  LargeVector<std::uint8_t> hits_;  ///< of each candidate: whether it overlapped in the last frame
  // Buffers for `compare_all_shared`, by stretch:
  LargeVector<Pair> found_pairs_;
  std::vector<Found> found_;
};

}  // namespace bvlab
