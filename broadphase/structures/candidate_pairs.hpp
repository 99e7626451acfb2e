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
    write_in_stretches(list, 0, count, [&](std::size_t first, std::size_t last, Pair* out) {
      return out + compare_keeping(ids, first, last, out, began, ended);
    });
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
    write_in_stretches(list, first, last, [&](std::size_t begin, std::size_t end, Pair* out) {
      for (const Pair& c : candidates_.view().subspan(begin, end - begin)) {
        *out = {ids[c.i], ids[c.j]};
        out += overlap<Contact>(rows[c.i], rows[c.j]);
      }
      return out;
    });
  }

 private:
  /// Appends what write(begin, end, out) writes for the candidates from `begin` to `end`; it
  /// returns where it ended. In stretches, so that of the list only pages that pairs are written to
  /// are brought in.
  template <class Write>
  static void write_in_stretches(PairList& list, std::size_t first, std::size_t last,
                                 const Write& write) {
    constexpr std::size_t stretch = 4096;
    for (; first < last; first += stretch) {
      const std::size_t end = std::min(first + stretch, last);
      list.set_end(write(first, end, list.reserve(end - first + 1)));
    }
  }

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
