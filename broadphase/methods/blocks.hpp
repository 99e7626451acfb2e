// SPDX-License-Identifier: BSD-3-Clause
/// Our own method. From scratch: boxes in spatial order, sixteen to a block, the tree of blocks
/// joined with itself by vector comparisons; O(n) to sort and O(n + k) to join where boxes are
/// alike.
///
/// With coherence, what is done follows what moved:
///
/// - nothing moved: the boxes are compared with the last frame's, and the list stands.
/// - moved steadily: *followed*. Every box gets a reach, where it will be for some frames if it
///   goes on as it just did, and the pairs of boxes whose reaches meet are candidates (BibTeX:
///   verlet1967computer; the reach is one-sided, along the motion of each face, so it grows the box
///   a quarter of what a margin would). Until a box leaves its reach, no pair but a candidate can
///   overlap, so a frame costs one look at every box and under two nanoseconds a candidate, in the
///   cache. For how many frames a reach is made is chosen so that those and making the next
///   candidates cost least together.
/// - a few moved: the same, but only their candidates are compared, and the list is changed in
///   place: the cost follows the number of boxes that moved, and of changes. A box that leaves its
///   reach gets a wider one, one that jumps or is new another slot.
/// - moved far: *refitted*. The tree's bounds are computed again and joined as from scratch.
/// - jumped: from scratch.
///
/// Every choice is made from counts, never from clocks, so the same frames give the same list.
#pragma once

#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include "broadphase/settings.hpp"
#include "broadphase/structures/block_tree.hpp"
#include "broadphase/structures/candidate_pairs.hpp"
#include "broadphase/structures/pair_difference.hpp"
#include "broadphase/structures/spatial_order.hpp"

namespace bvlab {

template <class T, class Contact>
class Blocks {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "blocks";
  static constexpr std::string_view description =
      "our own: blocks of sixteen neighbours joined by vector comparisons, then followed as they "
      "move";

  explicit Blocks(const MethodSettings& settings) : settings_(settings) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    began_.clear();
    ended_.clear();
    if (settings_.coherence == Coherence::off || !advance(boxes)) from_scratch(boxes);
    count_ = boxes.size();
    return pairs_.view();
  }

  PairChanges changes() const { return {began_.view(), ended_.view()}; }

  /// What the last frame was answered by.
  std::string_view reason() const { return reason_; }
  /// Into how many classes of size and shape boxes were last sorted.
  std::uint32_t classes() const { return order_.classes(); }

  std::size_t bytes() const {
    return tree_.bytes() + order_.bytes() + candidates_.bytes() +
           sizeof(Pair) * (pairs_.capacity() + began_.capacity() + ended_.capacity() +
                           before_.capacity() + after_.capacity()) +
           (reaches_.capacity() + spare_.capacity() + last_rows_.capacity()) * sizeof(Row<T>) +
           previous_.capacity() * sizeof(Box<T>) + 4 * slots_.capacity();
  }

 private:
  enum class State { empty, loose, followed };

  // ---- from scratch -------------------------------------------------------------------------

  void from_scratch(Boxes<T> boxes) {
    tree_.build(order_(boxes), boxes);
    measure_leaves();
    write_all_pairs();
    fresh_visits_ = visits_;
    state_ = State::loose;
    previous_known_ = false;
    reason_ = "from scratch: no earlier frame to use, or boxes jumped";
  }

  void measure_leaves() {
    double sum = 0;
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) {
      const Box<T> reach = tree_.reach(k);
      for (int axis = 0; axis < 3; ++axis)
        sum += static_cast<double>(reach.hi[axis]) - static_cast<double>(reach.lo[axis]);
    }
    leaf_size_ = tree_.leaves() ? sum / (3.0 * tree_.leaves()) : 0;
  }

  /// Joins the tree with itself into the list of pairs; reaches are the leaves' bounds.
  void write_all_pairs() {
    const bool compare = settings_.changes == Changes::reported;
    if (compare) keep_before();
    PairList& list = pairs_;
    list.clear();
    const bool alone = settings_.threads <= 1 || tree_.leaves() < leaves_worth_sharing;
    visits_ = 0;
    tree_.join([&](std::uint32_t a, std::uint32_t b) {
      ++visits_;
      if (alone) add_pairs(list, a, b);
    });
    if (!alone) join_in_shares(list);
    if (compare) difference_(before_.view(), pairs_.view(), began_, ended_);
  }
  void add_pairs(PairList& list, std::uint32_t a, std::uint32_t b) const {
    Pair* out = list.room_for(block_width * block_width + block_width);
    list.end_at(a == b ? pairs_within(out, a) : pairs_between(out, a, b));
  }
  /// Every thread walks the tree, which is cheap, and compares its share of the leaf pairs.
  void join_in_shares(PairList& list) {
    in_shares(list, [&](std::size_t t, std::size_t threads, PairList& share) {
      const std::size_t first = visits_ * t / threads, last = visits_ * (t + 1) / threads;
      std::size_t at = 0;
      tree_.join([&](std::uint32_t a, std::uint32_t b) {
        if (at >= first && at < last) add_pairs(share, a, b);
        ++at;
      });
    });
  }
  /// Calls work(t, threads, share) on every thread. Shares follow each other, so the list is the
  /// one that a single thread would have written; the first of them is the list itself.
  template <class Work>
  void in_shares(PairList& list, Work&& work) {
    const auto threads = static_cast<std::size_t>(settings_.threads);
    shares_.resize(threads - 1);
    {
      std::vector<std::jthread> others;
      for (std::size_t t = 1; t < threads; ++t)
        others.emplace_back([&, t] {
          shares_[t - 1].clear();
          work(t, threads, shares_[t - 1]);
        });
      work(0, threads, list);
    }
    for (const PairList& share : shares_) list.append(share.view());
  }
  /// Below this a thread takes longer to start than the join does.
  static constexpr std::uint32_t leaves_worth_sharing = 1000;
  static constexpr std::size_t candidates_worth_sharing = 100000;
  Pair* pairs_within(Pair* out, std::uint32_t a) const {
    const Block<T>& block = tree_.leaf(a);
    const Loaded<T> loaded(block);
    const std::uint32_t* ids = tree_.ids(a);
    for (int row = 0; row < block_width - 1; ++row)
      out = write_pairs(
          out, ids[row], ids,
          loaded.template overlapping<Contact>(block.box(row)) & (all_lanes << (row + 1)));
    return out;
  }
  Pair* pairs_between(Pair* out, std::uint32_t a, std::uint32_t b) const {
    const Loaded<T> left(tree_.leaf(a)), right(tree_.leaf(b));
    const LaneMask rows = left.template overlapping<Closed>(tree_.reach(b));
    const LaneMask columns = right.template overlapping<Closed>(tree_.reach(a));
    if (std::popcount(rows) <= std::popcount(columns)) return pairs_of_rows(out, a, b, right, rows);
    return pairs_of_rows(out, b, a, left, columns);
  }
  Pair* pairs_of_rows(Pair* out, std::uint32_t a, std::uint32_t b, const Loaded<T>& right,
                      LaneMask rows) const {
    const Block<T>& left = tree_.leaf(a);
    const std::uint32_t* left_ids = tree_.ids(a);
    const std::uint32_t* right_ids = tree_.ids(b);
    for (; rows; rows &= rows - 1) {
      const int row = std::countr_zero(rows);
      out = write_pairs(out, left_ids[row], right_ids,
                        right.template overlapping<Contact>(left.box(row)));
    }
    return out;
  }

  // ---- the next frame -----------------------------------------------------------------------

  /// How a sample of the boxes moved since the last frame, beside how large they are.
  struct Motion {
    double extent[3] = {}, step[3] = {};  ///< sums, without those that jumped
    std::size_t seen = 0, jumped = 0, moved = 0;
  };

  /// Brings the answer of the last frame up to this one; false where from scratch is better.
  bool advance(Boxes<T> boxes) {
    if (state_ == State::empty || count_ == 0 || boxes.empty()) return false;
    const bool resized = boxes.size() != count_;
    if (resized &&
        (state_ == State::loose || 8 * distance(boxes.size(), count_) > boxes.size() + 64))
      return false;
    if (!resized && same_as_previous(boxes)) {
      reason_ = "kept: nothing moved";
      return true;
    }
    if (state_ == State::followed && (resized || few_moved_ || age_ < horizon_))
      return follow(boxes);
    if (state_ == State::loose && waiting_ > 0) {
      --waiting_;
      return false;
    }
    const Motion motion = sample(boxes);
    if (2 * motion.jumped > motion.seen) return in_vain();
    if (motion.moved == 0 && state_ == State::loose && unmoved(boxes)) {
      remember(boxes);
      reason_ = "kept: nothing moved";
      return true;
    }
    const int horizon = best_horizon(motion);
    if (horizon == 0) return refit(boxes) || in_vain();
    wait_ = 0;
    if (settings_.changes == Changes::reported && state_ == State::followed)
      return renew_quietly(boxes, horizon);
    find_candidates(boxes, horizon, settings_.changes);
    reason_ = "followed: new candidates for the frames to come";
    return true;
  }

  /// Looking at how boxes moved costs something, too: the more often it led to nothing, the longer
  /// it is left alone, up to seven frames.
  bool in_vain() {
    waiting_ = wait_ = std::min(7, 2 * wait_ + 1);
    return false;
  }

  /// Whether the boxes are bit for bit those of the last frame, as far as that is known.
  bool same_as_previous(Boxes<T> boxes) const {
    if (!previous_known_) return false;
    for (std::size_t first = 0; first < boxes.size(); first += stretch)
      if (!same(boxes.data() + first, previous_.data() + first,
                std::min(stretch, boxes.size() - first)))
        return false;
    return true;
  }
  static constexpr std::size_t stretch = 64;  ///< boxes compared before looking at the outcome
  static bool same(const Box<T>* a, const Box<T>* b, std::size_t count) {
    return std::memcmp(a, b, count * sizeof(Box<T>)) == 0;
  }
  void remember(Boxes<T> boxes) {
    previous_.assign(boxes.begin(), boxes.end());
    previous_known_ = true;
  }
  static std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

  /// The last frame's box in this slot.
  Row<T> last_row(std::uint32_t slot) const {
    if (state_ == State::followed) return candidates_.rows()[slot];
    return row_of(tree_.leaf(slot / block_width).box(static_cast<int>(slot % block_width)));
  }
  bool jumped(const Row<T>& now, const Row<T>& was) const {
    return !(static_cast<double>(largest_change(now, was)) <= leaf_size_ / 2);
  }

  Motion sample(Boxes<T> boxes) const {
    Motion motion;
    const std::uint32_t stride = std::max<std::uint32_t>(1, tree_.leaves() / 32);
    for (std::uint32_t k = 0; k < tree_.leaves(); k += stride)
      for (std::uint32_t slot = k * block_width; slot < (k + 1) * block_width; ++slot) {
        const std::uint32_t id = tree_.ids(0)[slot];
        if (id == no_box || id >= boxes.size()) continue;
        const Row<T> now = row_of(boxes[id]), was = last_row(slot);
        ++motion.seen;
        motion.moved += !bvlab::same(now, was);
        if (jumped(now, was)) {
          ++motion.jumped;
          continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
          motion.extent[axis] += static_cast<double>(now.hi[axis] - now.lo[axis]);
          const double low = static_cast<double>(was.lo[axis] - now.lo[axis]),
                       high = static_cast<double>(now.hi[axis] - was.hi[axis]);
          motion.step[axis] +=
              steady_ ? std::max(low, 0.0) + std::max(high, 0.0) : std::abs(low) + std::abs(high);
        }
      }
    return motion;
  }
  bool unmoved(Boxes<T> boxes) const {
    for (std::uint32_t slot = 0; slot < tree_.slots(); ++slot)
      if (const std::uint32_t id = tree_.ids(0)[slot];
          id != no_box && !bvlab::same(row_of(boxes[id]), last_row(slot)))
        return false;
    return true;
  }

  // ---- refitted -----------------------------------------------------------------------------

  /// Joins the tree again with the leaves' bounds as they are; false where a new order costs less
  /// than what boxes, spread since the last one, are going to add to the join.
  bool refit(Boxes<T> boxes) {
    const double spread = static_cast<double>(visits_) - static_cast<double>(fresh_visits_);
    const bool holey = tree_.slots() >= boxes.size() + block_width;
    if (holey ||
        join_cost * (spread + spreading_) > sort_cost * static_cast<double>(boxes.size())) {
      spreading_ *= 0.9;  // to be tried again some time
      return false;
    }
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) {
      gather(tree_.leaf(k), tree_.ids(k), boxes);
      tree_.set_reach(k, bounds(tree_.leaf(k)));
    }
    tree_.refit_above();
    state_ = State::loose;
    previous_known_ = false;
    const std::size_t before = visits_;
    write_all_pairs();
    spreading_ = std::max(0.0, static_cast<double>(visits_) - static_cast<double>(before));
    reason_ = "refitted: boxes move too far to be followed";
    return true;
  }

  // ---- followed -----------------------------------------------------------------------------

  /// For how many frames reaches are best made; 0 where starting over costs less. In units of a
  /// nanosecond or so, as measured once; what counts is their ratios.
  int best_horizon(const Motion& motion) const {
    const double n = static_cast<double>(count_), k = static_cast<double>(pairs_.size());
    const double join = join_cost * static_cast<double>(fresh_visits_);
    double best = 0.9 * (sort_cost * n + join + pair_cost * k);
    int horizon = 0;
    for (int frames = 1; frames <= longest_; frames *= 2) {
      double growth = 1;
      for (int axis = 0; axis < 3; ++axis)
        if (motion.extent[axis] > 0)
          growth *= 1 + (frames + 0.5) * motion.step[axis] / motion.extent[axis];
      const double candidates = growth * k;
      const double cost =
          look_cost * n + test_cost * candidates +
          (list_cost * n + (1 + growth) / 2 * join + candidate_cost * candidates) / frames;
      if (cost < best) best = cost, horizon = frames;
    }
    return horizon;
  }
  static constexpr double sort_cost = 12, join_cost = 36, pair_cost = 1.3;  // from scratch
  static constexpr double look_cost = 4.5, test_cost = 1.8;                 // a frame, followed
  static constexpr double list_cost = 10, candidate_cost = 3;               // new candidates

  /// Where a box will be for `frames` more frames, moving as it just did; where boxes have turned
  /// out not to, a margin all around. Nothing depends on its being right.
  Row<T> reach_of(const Row<T>& now, const Row<T>& was, int frames) const {
    if (jumped(now, was)) return now;
    const Four<T> zero{}, low = now.lo - was.lo, high = now.hi - was.hi;
    const Four<T> far = most<T>(absolute<T>(low), absolute<T>(high));
    Row<T> reach;
    if (steady_) {
      const T ahead = static_cast<T>(frames);
      // A quarter of a step for what rounding adds up to.
      reach = {now.lo + least<T>(low * ahead, zero) - far / 4,
               now.hi + most<T>(high * ahead, zero) + far / 4};
    } else {
      const T widest = std::max({far[0], far[1], far[2]}) * static_cast<T>(frames);
      reach = {now.lo - widest, now.hi + widest};
    }
    constexpr T limit = std::numeric_limits<T>::max();
    return {most<T>(reach.lo, zero - limit), least<T>(reach.hi, zero + limit)};
  }

  /// Where changes are reported, the old candidates, which are good for one frame more, tell them
  /// before new ones are found; to compare two whole lists would cost more.
  bool renew_quietly(Boxes<T> boxes, int horizon) {
    auto& rows = candidates_.rows();
    last_rows_ = rows;
    if (!follow(boxes)) return false;
    if (!newcomers_.empty() || !emptied_.empty()) return true;  // slots changed: next time
    std::swap(rows, last_rows_);
    find_candidates(boxes, horizon, Changes::unreported);
    return true;
  }

  /// Reaches, the candidates, and all pairs.
  void find_candidates(Boxes<T> boxes, int horizon, Changes changes) {
    const bool compare = changes == Changes::reported;
    if (compare) keep_before();
    sort_if_due(boxes);
    auto& rows = candidates_.rows();
    const std::uint32_t slots = tree_.slots();
    if (state_ == State::loose) {
      rows.resize(slots);
      for (std::uint32_t slot = 0; slot < slots; ++slot) rows[slot] = last_row(slot);
    }
    slots_.resize(boxes.size());
    reaches_.resize(slots);
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
      const std::uint32_t id = tree_.ids(0)[slot];
      Box<T> reach = nowhere<T>();
      if (id == no_box) {
        rows[slot] = nowhere_row<T>();
      } else {
        const Row<T> now = row_of(boxes[id]);
        const Row<T> expected = reach_of(now, rows[slot], horizon);
        reaches_[slot].lo = expected.lo, reaches_[slot].hi = expected.hi;
        reach = box_of(expected);
        rows[slot].lo = now.lo, rows[slot].hi = now.hi;
        slots_[id] = slot;
      }
      tree_.leaf(slot / block_width).put(static_cast<int>(slot % block_width), reach);
    }
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) tree_.set_reach(k, bounds(tree_.leaf(k)));
    tree_.refit_above();
    candidates_.clear();
    list_visits_ = 0;
    tree_.join([&](std::uint32_t a, std::uint32_t b) {
      ++list_visits_;
      add_candidates(a, b);
    });
    if (sorted_) list_visits_when_sorted_ = list_visits_, sorted_ = false;
    candidates_at_first_ = candidates_.size();
    state_ = State::followed;
    horizon_ = horizon, age_ = 0;
    few_moved_ = false;
    previous_known_ = false;
    write_candidates(settings_.changes == Changes::reported ? Keep::places : Keep::nothing);
    if (compare) difference_(before_.view(), pairs_.view(), began_, ended_);
  }
  /// A new order, once the old one costs a third more or holds slots that are empty.
  void sort_if_due(Boxes<T> boxes) {
    if (state_ == State::loose) {
      sorted_ = true;
      return;
    }
    const bool holey = tree_.slots() >= boxes.size() + block_width;
    if (!holey && 3 * list_visits_ < 4 * list_visits_when_sorted_) return;
    const auto order = order_(boxes);
    auto& rows = candidates_.rows();
    spare_.resize((order.size() + block_width - 1) / block_width * block_width);
    for (std::size_t k = 0; k < order.size(); ++k) spare_[k] = rows[slots_[order[k].id]];
    std::swap(rows, spare_);
    tree_.build(order, boxes);
    measure_leaves();
    sorted_ = true;
  }
  void add_candidates(std::uint32_t a, std::uint32_t b) {
    const Block<T>& left = tree_.leaf(a);
    const Loaded<T> right(tree_.leaf(b));
    const std::uint32_t* ids = tree_.ids(a);
    PairList& list = candidates_.list();
    Pair* out = list.room_for(block_width * block_width + block_width);
    LaneMask rows = a == b ? all_lanes : overlapping_lanes<Closed>(left, tree_.reach(b));
    for (; rows; rows &= rows - 1) {
      const int row = std::countr_zero(rows);
      LaneMask lanes = right.template overlapping<Closed>(left.box(row));
      if (a == b) lanes &= all_lanes << (row + 1);
      out = write_pairs_by_id(out, a * block_width + static_cast<std::uint32_t>(row), ids[row],
                              b * block_width, tree_.ids(b), lanes & all_lanes);
    }
    list.end_at(out);
  }

  using Keep = typename CandidatePairs<T, Contact>::Keep;
  void write_candidates(Keep keep) {
    pairs_.clear();
    const std::size_t count = candidates_.size();
    if (keep != Keep::nothing || settings_.threads <= 1 || count < candidates_worth_sharing)
      return candidates_.compare_all(tree_.ids(0), pairs_, keep, began_, ended_);
    candidates_.forget_places();
    in_shares(pairs_, [&](std::size_t t, std::size_t threads, PairList& share) {
      candidates_.compare_range(tree_.ids(0), share, count * t / threads,
                                count * (t + 1) / threads);
    });
  }

  /// One frame in which boxes mostly stayed within their reaches; false where too many did not.
  bool follow(Boxes<T> boxes) {
    moved_.clear(), escaped_.clear(), newcomers_.clear(), emptied_.clear();
    moved_count_ = 0;
    for (std::size_t id = boxes.size(); id < count_; ++id) vacate(slots_[id]);
    const std::size_t staying = std::min(boxes.size(), count_);
    if (previous_known_)
      look_by_index(boxes, staying);
    else
      look_by_slot(boxes, staying);
    for (std::size_t id = count_; id < boxes.size(); ++id)
      newcomers_.push_back(static_cast<std::uint32_t>(id));
    // Each of these costs about as much as starting over does for thirty boxes, or a hundred.
    if (32 * escaped_.size() + 100 * newcomers_.size() > boxes.size() + 3200) {
      if (age_ < horizon_ && newcomers_.size() < escaped_.size()) distrust();
      return false;
    }
    widen_escaped();
    if (!newcomers_.empty()) seat_newcomers(boxes);
    few_moved_ = few(moved_count_);
    moved_.insert(moved_.end(), emptied_.begin(), emptied_.end());
    compare();
    for (const std::uint32_t slot : emptied_) tree_.ids(0)[slot] = no_box;
    if (settings_.changes == Changes::reported && !emptied_.empty()) cancel_out();
    if (few_moved_ != previous_known_ || boxes.size() != count_) {
      previous_known_ = false;
      if (few_moved_) remember(boxes);
    }
    ++age_;
    reason_ = few_moved_ ? "followed: few moved, only theirs are compared"
                         : "followed: candidates are compared";
    if (too_many_candidates(boxes)) age_ = horizon_, few_moved_ = false;
    return true;
  }
  bool few(std::size_t moved) const { return 4 * moved < tree_.slots(); }
  bool too_many_candidates(Boxes<T> boxes) const {
    return candidates_.size() > 2 * candidates_at_first_ + boxes.size() ||
           tree_.slots() > boxes.size() + boxes.size() / 8 + 64;
  }
  /// Boxes left the reaches made for them: they turn too often for that, or speed up.
  void distrust() {
    if (steady_)
      steady_ = false;
    else
      longest_ = std::max(1, longest_ / 2);
  }

  /// In the order of the frame, beside a copy of the last one: best where few moved.
  void look_by_index(Boxes<T> boxes, std::size_t staying) {
    for (std::size_t first = 0; first < staying; first += stretch) {
      const std::size_t last = std::min(first + stretch, staying);
      if (same(boxes.data() + first, previous_.data() + first, last - first)) continue;
      for (std::size_t id = first; id < last; ++id) {
        if (boxes[id] == previous_[id]) continue;
        previous_[id] = boxes[id];
        const std::uint32_t slot = slots_[id];
        Row<T>& row = candidates_.rows()[slot];
        const Row<T> was = row;
        row = row_of(boxes[id]);
        moved_.push_back(slot);
        if (!inside(row, reaches_[slot])) leave_reach(slot, was);
      }
    }
    moved_count_ = moved_.size();
  }
  /// In the order of slots: best where most moved.
  void look_by_slot(Boxes<T> boxes, std::size_t staying) {
    const std::uint32_t slots = tree_.slots();
    const std::uint32_t* ids = tree_.ids(0);
    Row<T>* const rows = candidates_.rows().data();
    const Row<T>* const reaches = reaches_.data();
    const std::size_t had = moved_.size();  // boxes that are gone
    moved_.resize(had + slots);
    std::uint32_t* moved = moved_.data() + had;
    // A frame that the cache holds is fetched in order, a longer one as it is needed.
    const bool far = boxes.size_bytes() > (1u << 20);
    if (!far)
      for (std::size_t byte = 0; byte < boxes.size_bytes(); byte += 64)
        __builtin_prefetch(reinterpret_cast<const char*>(boxes.data()) + byte, 0, 2);
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
      if (far && slot + ahead < slots && ids[slot + ahead] < staying)
        __builtin_prefetch(&boxes[ids[slot + ahead]]);
      if (ids[slot] >= staying) continue;
      const Row<T> was = rows[slot], now = row_of(boxes[ids[slot]]);
      // Both halves by themselves: copied whole, they would go through memory.
      rows[slot].lo = now.lo, rows[slot].hi = now.hi;
      *moved = slot;
      moved += !bvlab::same(now, was);
      if (!inside(now, reaches[slot])) [[unlikely]] {
        const Row<T> left = was;  // its address is taken: `was` itself can stay in registers
        leave_reach(slot, left);
      }
    }
    moved_count_ = static_cast<std::size_t>(moved - moved_.data());
    moved_.resize(moved_count_);
  }
  static constexpr std::uint32_t ahead = 16;  ///< slots whose boxes are on their way from memory

  void leave_reach(std::uint32_t slot, const Row<T>& was) {
    if (!jumped(candidates_.rows()[slot], was)) {
      escaped_.push_back({slot, was});
      return;
    }
    newcomers_.push_back(tree_.ids(0)[slot]);
    vacate(slot);
  }
  /// Its pairs end with this frame; candidates of the slot stay and are never found again.
  void vacate(std::uint32_t slot) {
    candidates_.rows()[slot] = nowhere_row<T>();
    tree_.leaf(slot / block_width).put(static_cast<int>(slot % block_width), nowhere<T>());
    emptied_.push_back(slot);
  }

  void widen_escaped() {
    for (const auto& [slot, was] : escaped_) {
      const Row<T> now = candidates_.rows()[slot], ahead = reach_of(now, was, horizon_);
      Row<T>& reach = reaches_[slot];
      const Box<T> old = box_of(reach);
      reach = {least<T>(least<T>(reach.lo, ahead.lo), now.lo),
               most<T>(most<T>(reach.hi, ahead.hi), now.hi)};
      enter(slot, old);
    }
  }
  /// Candidates are all pairs whose reaches meet: adds those that the new reach of this slot meets
  /// and the old one did not.
  void enter(std::uint32_t slot, const Box<T>& old) {
    const Box<T> reach = box_of(reaches_[slot]);
    const std::uint32_t* ids = tree_.ids(0);
    tree_.widen(slot, reach);
    tree_.find(reach, [&](std::uint32_t k) {
      const Loaded<T> block(tree_.leaf(k));
      LaneMask lanes =
          block.template overlapping<Closed>(reach) & ~block.template overlapping<Closed>(old);
      for (; lanes; lanes &= lanes - 1) {
        const std::uint32_t other = k * block_width + std::countr_zero(lanes);
        if (other != slot) candidates_.add(slot, ids[slot], other, ids[other]);
      }
    });
  }

  /// Boxes that jumped or are new get slots of their own, among themselves in spatial order.
  void seat_newcomers(Boxes<T> boxes) {
    std::erase_if(newcomers_, [&](std::uint32_t id) { return id >= boxes.size(); });
    new_boxes_.clear();
    for (const std::uint32_t id : newcomers_) new_boxes_.push_back(boxes[id]);
    const auto order = newcomers_order_(new_boxes_);
    const std::uint32_t first = tree_.slots();
    tree_.resize_leaves(tree_.leaves() +
                        static_cast<std::uint32_t>((order.size() + block_width - 1) / block_width));
    tree_.refit_above();
    slots_.resize(boxes.size());
    auto& rows = candidates_.rows();
    rows.resize(tree_.slots(), nowhere_row<T>());
    reaches_.resize(tree_.slots());
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::uint32_t id = newcomers_[order[k].id];
      const std::uint32_t slot = first + static_cast<std::uint32_t>(k);
      tree_.ids(0)[slot] = id;
      slots_[id] = slot;
      rows[slot] = reaches_[slot] = row_of(boxes[id]);
      enter(slot, nowhere<T>());
      moved_.push_back(slot);
    }
    moved_count_ += order.size();
  }

  void compare() {
    if (few_moved_ && candidates_.places_known())
      return candidates_.compare_some(moved_, tree_.ids(0), pairs_, began_, ended_);
    write_candidates(settings_.changes == Changes::reported ? Keep::changes
                     : few_moved_                           ? Keep::places
                                                            : Keep::nothing);
  }

  /// A pair that ended in one slot and began in another, where its box went, did neither.
  void cancel_out() {
    before_.clear();
    before_.append(ended_.view());
    after_.clear();
    after_.append(began_.view());
    difference_(before_.view(), after_.view(), began_, ended_);
  }
  void keep_before() {
    before_.clear();
    before_.append(pairs_.view());
  }

  MethodSettings settings_;
  State state_ = State::empty;
  std::size_t count_ = 0;  ///< boxes of the last frame
  std::string_view reason_;
  SpatialOrder<T> order_, newcomers_order_;
  BlockTree<T> tree_;  ///< loose: of the boxes; followed: of their reaches
  PairList pairs_;
  double leaf_size_ = 0;  ///< mean extent of a leaf after sorting
  std::size_t visits_ = 0, fresh_visits_ = 0;
  double spreading_ = 0;  ///< visits that the last refit added

  CandidatePairs<T, Contact> candidates_;
  std::vector<Row<T>> reaches_, spare_, last_rows_;
  std::vector<std::uint32_t> slots_;  ///< of each box
  std::size_t candidates_at_first_ = 0, list_visits_ = 0, list_visits_when_sorted_ = 0;
  bool sorted_ = false;
  bool steady_ = true;  ///< boxes have gone on as they did
  int longest_ = 64, horizon_ = 0, age_ = 0;
  int wait_ = 0, waiting_ = 0;  ///< frames to start over without asking

  struct Escaped {
    std::uint32_t slot;
    Row<T> was;
  };
  std::vector<Escaped> escaped_;
  std::vector<std::uint32_t> moved_, newcomers_, emptied_;
  std::size_t moved_count_ = 0;
  bool few_moved_ = false;
  std::vector<Box<T>> previous_, new_boxes_;
  bool previous_known_ = false;

  PairList began_, ended_, before_, after_;
  std::vector<PairList> shares_;
  PairDifference difference_;
};

}  // namespace bvlab
