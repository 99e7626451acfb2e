// SPDX-License-Identifier: BSD-3-Clause
/// Pairs that may overlap, and the list of those that do. Boxes stand in slots, as rows. A frame
/// that moved most of them compares every candidate, under two nanoseconds each in the cache, and
/// writes the list anew; one that moved few compares theirs alone, found by links from slot to
/// candidate, and changes the list in place: O(1) for a pair that began or ended, since each
/// candidate knows its place in the list and each place its candidate.
///
/// 8 bytes a candidate, and 20 more once it is followed in place.
#pragma once

#include <utility>
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
  /// What a comparison of every candidate leaves behind besides the list.
  enum class Keep { nothing, places, changes };

  /// No candidates any more; rows stay, and so does the list.
  void clear() {
    candidates_.clear();
    places_known_ = linked_ = false;
  }
  std::size_t size() const { return candidates_.size(); }
  /// Pairs of slots, the one whose box has the smaller index in the frame first. May be written to
  /// while neither places nor links are known.
  PairList& list() { return candidates_; }

  LargeVector<Row<T>>& rows() { return rows_; }
  const LargeVector<Row<T>>& rows() const { return rows_; }

  /// `a` and `b` are slots with these box indices; the pair must not be there yet.
  void add(std::uint32_t a, std::uint32_t id_a, std::uint32_t b, std::uint32_t id_b) {
    const auto c = static_cast<std::uint32_t>(candidates_.size());
    candidates_.push(id_a < id_b ? Pair{a, b} : Pair{b, a});
    if (places_known_) places_.push_back(nowhere_in_list);
    if (linked_) {
      links_.resize(2 * std::size_t{c} + 2);
      link(c);
    }
  }

  bool places_known() const { return places_known_; }
  void forget_places() { places_known_ = false; }

  /// Compares all. `ids` gives each slot's box; with `Keep::changes` pairs that began and ended
  /// since the last comparison are added to these lists.
  void compare_all(const std::uint32_t* ids, PairList& list, Keep keep, PairList& began,
                   PairList& ended) {
    if (keep == Keep::nothing) {
      places_known_ = false;
      return compare_range(ids, list, 0, candidates_.size());
    }
    const bool changed = keep == Keep::changes && places_known_;
    const std::size_t count = candidates_.size();
    list.clear();
    places_.resize(count);
    origins_.resize(count + 1);
    Pair* const to = list.room_for(count + 1);
    list.end_at(
        to + (changed ? compare_keeping<true>(ids, 0, count, to, origins_.data(), began, ended)
                      : compare_keeping<false>(ids, 0, count, to, origins_.data(), began, ended)));
    places_known_ = true;
  }

  /// The same by several threads, with places or changes: the same lists in the same order. Each
  /// stretch of candidates is compared into room of its own, then put behind the one before.
  void compare_all_shared(const std::uint32_t* ids, PairList& list, Keep keep, PairList& began,
                          PairList& ended, Threads& threads) {
    const bool changed = keep == Keep::changes && places_known_;
    const std::size_t count = candidates_.size();
    constexpr std::size_t stretch = 1024;
    places_.resize(count);
    origins_.resize(count + 1);
    found_pairs_.resize(count), found_origins_.resize(count);
    found_.resize((count + stretch - 1) / stretch);
    const auto last_of = [&](std::size_t k) { return std::min((k + 1) * stretch, count); };
    threads.share(found_.size(), [&](std::size_t k, std::size_t) {
      Found& found = found_[k];
      const std::size_t first = k * stretch;
      Pair* const to = found_pairs_.data() + first;
      std::uint32_t* const origins = found_origins_.data() + first;
      found.began.clear(), found.ended.clear();
      found.count = changed ? compare_keeping<true>(ids, first, last_of(k), to, origins,
                                                    found.began, found.ended)
                            : compare_keeping<false>(ids, first, last_of(k), to, origins,
                                                     found.began, found.ended);
    });
    std::uint32_t sum = 0;
    for (Found& found : found_) {
      found.first = sum, sum += found.count;
      began.append(found.began.view()), ended.append(found.ended.view());
    }
    list.clear();
    Pair* const pairs = list.room_to_share(sum);
    threads.share(found_.size(), [&](std::size_t k, std::size_t) {
      const auto [first, here] = std::pair(k * stretch, found_[k].first);
      std::copy_n(found_pairs_.data() + first, found_[k].count, pairs + here);
      std::copy_n(found_origins_.data() + first, found_[k].count, origins_.data() + here);
      for (std::size_t c = first; c < last_of(k); ++c)
        places_[c] += places_[c] != nowhere_in_list ? here : 0;
    });
    list.end_at(pairs + sum);
    places_known_ = true;
  }

  /// The candidates from `first` to `last` alone, added to the list.
  void compare_range(const std::uint32_t* ids, PairList& list, std::size_t first,
                     std::size_t last) const {
    Pair* out = list.room_for(last - first + 1);
    const Row<T>* rows = rows_.data();
    for (const Pair *c = candidates_.view().data() + first, *end = c + (last - first); c != end;
         ++c) {
      *out = {ids[c->i], ids[c->j]};
      out += overlap<Contact>(rows[c->i], rows[c->j]);
    }
    list.end_at(out);
  }

  /// Compares the candidates of these slots. Places must be known.
  void compare_some(std::span<const std::uint32_t> slots, const std::uint32_t* ids, PairList& list,
                    PairList& began, PairList& ended) {
    if (!linked_) link_all();
    for (const std::uint32_t slot : slots) {
      if (slot >= heads_.size()) continue;
      for (std::uint32_t at = heads_[slot]; at != end_of_links; at = links_[at]) {
        const std::uint32_t c = at / 2;
        const Pair& candidate = candidates_[c];
        const bool hit = overlap<Contact>(rows_[candidate.i], rows_[candidate.j]);
        if (hit == (places_[c] != nowhere_in_list)) continue;
        if (hit)
          insert(c, {ids[candidate.i], ids[candidate.j]}, list, began);
        else
          remove(c, list, ended);
      }
    }
  }

  std::size_t bytes() const {
    return rows_.capacity() * sizeof(Row<T>) + candidates_.capacity() * sizeof(Pair) +
           sizeof(Pair) * found_pairs_.capacity() +
           4 * (places_.capacity() + origins_.capacity() + heads_.capacity() + links_.capacity() +
                found_origins_.capacity());
  }

 private:
  static constexpr std::uint32_t nowhere_in_list = 0xffffffffu;
  static constexpr std::uint32_t end_of_links = 0xffffffffu;

  /// Compares the candidates from `first` to `last`; says how many overlap. Their pairs and origins
  /// go to these places, and theirs begin at 0.
  template <bool Changed>
  std::uint32_t compare_keeping(const std::uint32_t* ids, std::size_t first, std::size_t last,
                                Pair* pairs, std::uint32_t* origins, PairList& began,
                                PairList& ended) {
    std::uint32_t found = 0;
    for (auto c = static_cast<std::uint32_t>(first); c < last; ++c) {
      const Pair candidate = candidates_[c];
      const Pair pair{ids[candidate.i], ids[candidate.j]};
      const bool hit = overlap<Contact>(rows_[candidate.i], rows_[candidate.j]);
      if (Changed && hit != (places_[c] != nowhere_in_list)) (hit ? began : ended).push(pair);
      places_[c] = hit ? found : nowhere_in_list;
      pairs[found] = pair;
      origins[found] = c;
      found += hit;
    }
    return found;
  }

  /// What one thread found among some candidates.
  struct Found {
    std::uint32_t first, count;  ///< of the list
    PairList began, ended;
  };

  void insert(std::uint32_t c, Pair pair, PairList& list, PairList& began) {
    places_[c] = static_cast<std::uint32_t>(list.size());
    origins_.resize(std::max(origins_.size(), list.size() + 1));
    origins_[list.size()] = c;
    list.push(pair);
    began.push(pair);
  }
  void remove(std::uint32_t c, PairList& list, PairList& ended) {
    const std::uint32_t place = places_[c];
    const auto last = static_cast<std::uint32_t>(list.size() - 1);
    ended.push(list[place]);
    list[place] = list[last];
    origins_[place] = origins_[last];
    places_[origins_[place]] = place;
    places_[c] = nowhere_in_list;
    list.resize_down(last);
  }

  void link_all() {
    heads_.assign(rows_.size(), end_of_links);
    links_.resize(2 * candidates_.size());
    linked_ = true;
    for (std::uint32_t c = 0; c < candidates_.size(); ++c) link(c);
  }
  /// Link 2c belongs to the first slot of candidate c, 2c + 1 to the second.
  void link(std::uint32_t c) {
    const Pair& candidate = candidates_[c];
    if (heads_.size() < rows_.size()) heads_.resize(rows_.size(), end_of_links);
    links_[2 * std::size_t{c}] = std::exchange(heads_[candidate.i], 2 * c);
    links_[2 * std::size_t{c} + 1] = std::exchange(heads_[candidate.j], 2 * c + 1);
  }

  LargeVector<Row<T>> rows_;
  PairList candidates_;
  bool places_known_ = false, linked_ = false;
  LargeVector<std::uint32_t> places_;   ///< of each candidate in the list
  LargeVector<std::uint32_t> origins_;  ///< of each place: its candidate
  LargeVector<std::uint32_t> heads_, links_;
  // Where threads share them, of each stretch:
  LargeVector<Pair> found_pairs_;
  LargeVector<std::uint32_t> found_origins_;
  std::vector<Found> found_;
};

}  // namespace bvlab
