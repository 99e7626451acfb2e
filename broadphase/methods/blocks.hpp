// SPDX-License-Identifier: BSD-3-Clause
/// Our own method. From scratch: boxes in spatial order, sixteen to a block, the tree of blocks
/// joined with itself by vector comparisons; O(n) to sort and O(n + k) to join where boxes are
/// alike.
///
/// With coherence, blocks stay together while their boxes move, and what is done follows what
/// moved:
///   nothing moved      the boxes are compared with the last frame's, and the list stands;
///   moved a little     *listed*: each leaf keeps a margin around it, and the pairs of leaves whose
///                      margins meet are kept in a list (BibTeX: verlet1967computer), each with the pairs
///                      of boxes found in it as bits and with the *slack* by which every one of its
///                      comparisons was decided: until the two leaves together have moved that far,
///                      none can come out otherwise and nothing is compared. What is compared
///                      changes bits; bits that change are the pairs that began and ended, and only
///                      those touch the list of pairs;
///   moved far          *refitted*: the tree's bounds are computed again and joined as from
///   scratch; jumped             a box that jumps leaves its leaf for a new one; when too many do,
///   or leaves
///                      have spread so far that the joins cost more than sorting: from scratch.
/// Every choice is made from counts, never from clocks, so the same frames give the same list.
#pragma once

#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include "broadphase/settings.hpp"
#include "broadphase/structures/block_tree.hpp"
#include "broadphase/structures/kept_pairs.hpp"
#include "broadphase/structures/pair_difference.hpp"
#include "broadphase/structures/spatial_order.hpp"

namespace bvlab {

template <class T, class Contact>
class Blocks {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "blocks";
  static constexpr std::string_view description =
      "our own: blocks of sixteen neighbours, joined by vector comparisons and kept while they "
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

  std::size_t bytes() const {
    return tree_.bytes() + pairs_.bytes() + entries_.capacity() * sizeof(Entry) +
           leaves_.capacity() * sizeof(Leaf) + previous_.capacity() * sizeof(Box<T>) +
           slots_.capacity() * sizeof(std::uint32_t);
  }

 private:
  enum class State { empty, loose, listed };

  /// Two leaves whose reaches meet, and which of their boxes overlap: bit l of rows[r] for box r of
  /// a and box l of b. A leaf is paired with itself, too.
  struct Entry {
    std::uint32_t a, b;
    double expiry;  ///< compared again once travel of a plus travel of b gets here
    Segment segment;
    std::array<std::uint16_t, block_width> rows;
  };

  /// What is known of a leaf besides its boxes.
  struct Leaf {
    Box<T> bounds;      ///< of its boxes as they stand
    Box<T> old_reach;   ///< what its reach was at the end of the last frame, if it changed
    double travel = 0;  ///< not less than what its boxes have moved since the list was made
    bool moved = false;
    bool must_compare = false;  ///< boxes left or came
    bool reach_changed = false;
  };

  /// How the boxes moved since the last frame.
  struct Motion {
    std::size_t leaves = 0;  ///< that moved, without those in which a box jumped
    double sum = 0;          ///< of the largest movement in each of them
    std::size_t jumped = 0;  ///< boxes that moved further than half a leaf
    double mean() const { return leaves ? sum / static_cast<double>(leaves) : 0; }
  };

  // ---- from scratch -------------------------------------------------------------------------

  void from_scratch(Boxes<T> boxes) {
    tree_.build(order_(boxes), boxes);
    measure_leaves();
    write_all_pairs();
    fresh_visits_ = visits_;
    state_ = State::loose;
    previous_known_ = false;
    emptied_.clear();
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
    if (compare) {
      before_.clear();
      before_.append(pairs_.view());
    }
    PairList& list = pairs_.rewritten();
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
  /// Every thread walks the tree, which is cheap, and compares its share of the leaf pairs. Shares
  /// follow each other, so the list is the one that a single thread would have written.
  void join_in_shares(PairList& list) {
    const auto threads = static_cast<std::size_t>(settings_.threads);
    shares_.resize(threads);
    const auto work = [&](std::size_t t) {
      shares_[t].clear();
      const std::size_t first = visits_ * t / threads, last = visits_ * (t + 1) / threads;
      std::size_t at = 0;
      tree_.join([&](std::uint32_t a, std::uint32_t b) {
        if (at >= first && at < last) add_pairs(shares_[t], a, b);
        ++at;
      });
    };
    {
      std::vector<std::jthread> others;
      for (std::size_t t = 1; t < threads; ++t) others.emplace_back(work, t);
      work(0);
    }
    for (const PairList& share : shares_) list.append(share.view());
  }
  /// Below this a thread takes longer to start than the join does.
  static constexpr std::uint32_t leaves_worth_sharing = 1000;
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
    const Lanes rows = left.template overlapping<Closed>(tree_.reach(b));
    const Lanes columns = right.template overlapping<Closed>(tree_.reach(a));
    if (std::popcount(rows) <= std::popcount(columns)) return pairs_of_rows(out, a, b, right, rows);
    return pairs_of_rows(out, b, a, left, columns);
  }
  Pair* pairs_of_rows(Pair* out, std::uint32_t a, std::uint32_t b, const Loaded<T>& right,
                      Lanes rows) const {
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

  /// Brings the answer of the last frame up to this one; false where from scratch is better.
  bool advance(Boxes<T> boxes) {
    if (state_ == State::empty || count_ == 0 || boxes.empty()) return false;
    if (boxes.size() != count_ &&
        (state_ == State::loose || 8 * distance(boxes.size(), count_) > count_))
      return false;
    if (boxes.size() == count_ && same_as_previous(boxes)) {
      reason_ = "kept: nothing moved";
      return true;
    }
    if (state_ == State::loose && most_jumped(boxes)) return false;
    const Motion motion = move(boxes);
    if (!motion.leaves && !motion.jumped && boxes.size() == count_) {
      remember(boxes);
      reason_ = "kept: nothing moved";
      return true;
    }
    // Every box that jumps costs about as much as sorting a hundred; where few are, anything is
    // cheap.
    if (100 * motion.jumped > boxes.size() + 3200) return false;
    const double step = motion.mean();
    if (state_ == State::listed) {
      margin_ = margin_for(step);
      if (list_pays(step) && update_list(boxes, step)) return true;
      // Leaves that boxes have left or come to are half changed: no tree to refit.
      if (boxes.size() != count_ || !emptied_.empty()) return false;
      state_ = State::loose;
      return refit(boxes);
    }
    if (list_pays(step)) {
      margin_ = margin_for(step);
      make_list(boxes, settings_.changes);
      reason_ = "listed: boxes move little, pairs of leaves are kept";
      return true;
    }
    return refit(boxes);
  }
  /// A margin of a few frames' motion must be small beside a leaf; and where a list was given up,
  /// since too little of it could be skipped, boxes must have slowed down a good deal.
  bool list_pays(double step) const {
    return step < 0.05 * leaf_size_ && step < 0.5 * step_given_up_;
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
  void remember(Boxes<T> boxes) {
    previous_.assign(boxes.begin(), boxes.end());
    previous_known_ = true;
  }
  static std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }
  T margin_for(double step) const {
    return static_cast<T>(std::clamp(8 * step, 0.02 * leaf_size_, 0.25 * leaf_size_));
  }

  /// Whether, of a sample of the leaves, most boxes moved further than half a leaf.
  bool most_jumped(Boxes<T> boxes) const {
    const std::uint32_t stride = std::max<std::uint32_t>(1, tree_.leaves() / 16);
    int jumped = 0, seen = 0;
    for (std::uint32_t k = 0; k < tree_.leaves(); k += stride)
      for (int lane = 0; lane < block_width; ++lane) {
        const std::uint32_t id = tree_.ids(k)[lane];
        if (id == no_box || id >= boxes.size()) continue;
        ++seen;
        jumped += largest_change(tree_.leaf(k).box(lane), boxes[id]) > leaf_size_ / 2;
      }
    return 2 * jumped > seen;
  }
  static double largest_change(const Box<T>& a, const Box<T>& b) {
    T most = 0;
    for (int axis = 0; axis < 3; ++axis)
      most = std::max({most, std::abs(a.lo[axis] - b.lo[axis]), std::abs(a.hi[axis] - b.hi[axis])});
    return static_cast<double>(most);
  }

  /// Copies the boxes that moved into their leaves.
  Motion move(Boxes<T> boxes) {
    leaves_.resize(tree_.leaves());
    jumpers_.clear();
    for (Leaf& leaf : leaves_) leaf.moved = leaf.must_compare = leaf.reach_changed = false;
    Motion motion;
    if (previous_known_ && boxes.size() == count_ && state_ == State::listed)
      move_those_that_differ(boxes, motion);
    else
      move_leaf_by_leaf(boxes, motion);
    return motion;
  }

  /// Looks at every leaf: best where most moved.
  void move_leaf_by_leaf(Boxes<T> boxes, Motion& motion) {
    Block<T> now;
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) {
      std::uint32_t* ids = tree_.ids(k);
      if (boxes.size() <
          count_)  // boxes that are gone leave their lanes empty, once their pairs have ended
        for (int lane = 0; lane < block_width; ++lane)
          if (ids[lane] != no_box && ids[lane] >= boxes.size()) leave(k, lane, Leaver::gone);
      gather_staying(now, k, boxes);
      Block<T>& block = tree_.leaf(k);
      const T change = settle_jumps(k, block, now, motion);
      if (change == 0 && !leaves_[k].must_compare) continue;
      block = now;
      note_motion(k, change, motion);
    }
    const bool few = 4 * motion.leaves < tree_.leaves();
    previous_known_ = false;
    if (few && state_ == State::listed) remember(boxes);
  }
  void gather_staying(Block<T>& now, std::uint32_t k, Boxes<T> boxes) {
    if (boxes.size() >= count_) return gather(now, tree_.ids(k), boxes);
    std::uint32_t ids[block_width];
    for (int lane = 0; lane < block_width; ++lane)
      ids[lane] = tree_.ids(k)[lane] < boxes.size() ? tree_.ids(k)[lane] : no_box;
    gather(now, ids, boxes);
  }
  /// The largest change of a coordinate among boxes that did not jump. In a listed tree those that
  /// did leave the leaf.
  T settle_jumps(std::uint32_t k, const Block<T>& was, Block<T>& now, Motion& motion) {
    alignas(64) T change[block_width] = {};
    for (int axis = 0; axis < 3; ++axis)
      for (int lane = 0; lane < block_width; ++lane) {
        const T lo = std::abs(now.lo[axis][lane] - was.lo[axis][lane]),
                hi = std::abs(now.hi[axis][lane] - was.hi[axis][lane]);
        change[lane] =
            lo > change[lane] ? lo : change[lane];  // NaN, of an empty lane, is not larger
        change[lane] = hi > change[lane] ? hi : change[lane];
      }
    T folded[block_width];
    std::copy_n(change, block_width, folded);
    for (int half = block_width / 2; half > 0; half /= 2)
      for (int lane = 0; lane < half; ++lane)
        folded[lane] = std::max(folded[lane], folded[lane + half]);
    T most = folded[0];
    const T limit = static_cast<T>(leaf_size_ / 2);
    if (most <= limit) return most;
    most = 0;
    for (int lane = 0; lane < block_width; ++lane) {
      if (change[lane] <= limit) {
        most = std::max(most, change[lane]);
        continue;
      }
      if (tree_.ids(k)[lane] == no_box || now.lo[0][lane] == std::numeric_limits<T>::infinity())
        continue;
      ++motion.jumped;
      if (state_ == State::listed) {
        leave(k, lane, Leaver::moves_on);
        now.put(lane, nowhere<T>());
      }
      leaves_[k].must_compare = true;
    }
    return most;
  }

  void note_motion(std::uint32_t k, T change, Motion& motion) {
    Leaf& leaf = leaves_[k];
    leaf.moved = true;
    // A difference of two T is off by a factor of 1 + u at most, a sum of doubles by 1 + u(double).
    leaf.travel = (leaf.travel +
                   static_cast<double>(change) * (1 + 2 * static_cast<double>(unit_roundoff<T>))) *
                  (1 + 4 * unit_roundoff<double>);
    if (leaf.must_compare) return;
    ++motion.leaves;
    motion.sum += static_cast<double>(change);
  }

  /// Looks at the boxes in the order of the frame, beside a copy of the last frame: best where few
  /// moved.
  void move_those_that_differ(Boxes<T> boxes, Motion& motion) {
    for (std::size_t first = 0; first < boxes.size(); first += stretch) {
      const std::size_t last = std::min(first + stretch, boxes.size());
      if (same(boxes.data() + first, previous_.data() + first, last - first)) continue;
      for (std::size_t id = first; id < last; ++id) {
        if (boxes[id] == previous_[id]) continue;
        move_one(static_cast<std::uint32_t>(id), boxes[id], motion);
        previous_[id] = boxes[id];
      }
    }
    for (const std::uint32_t k : moved_leaves_)
      note_motion(k, largest_[k], motion), largest_[k] = 0;
    moved_leaves_.clear();
    if (4 * motion.leaves > tree_.leaves()) previous_known_ = false;
  }
  static constexpr std::size_t stretch = 64;  ///< boxes compared before looking at the outcome
  static bool same(const Box<T>* a, const Box<T>* b, std::size_t count) {
    const T *x = a->lo, *y = b->lo;
    bool differ = false;
    for (std::size_t k = 0; k < 6 * count; ++k) differ |= x[k] != y[k];
    return !differ;
  }
  void move_one(std::uint32_t id, const Box<T>& box, Motion& motion) {
    const std::uint32_t slot = slots_[id], k = slot / block_width;
    const int lane = static_cast<int>(slot % block_width);
    Leaf& leaf = leaves_[k];
    largest_.resize(leaves_.size(), 0);
    if (!leaf.moved) {
      leaf.moved = true;
      moved_leaves_.push_back(k);
    }
    const double change = largest_change(previous_[id], box);
    if (change > leaf_size_ / 2) {
      ++motion.jumped;
      leave(k, lane, Leaver::moves_on);
      tree_.leaf(k).put(lane, nowhere<T>());
      return;
    }
    tree_.leaf(k).put(lane, box);
    largest_[k] = std::max(largest_[k], static_cast<T>(change));
  }

  enum class Leaver { moves_on, gone };
  void leave(std::uint32_t k, int lane, Leaver why) {
    leaves_[k].must_compare = true;
    if (state_ != State::listed) return;
    emptied_.push_back(k * block_width + static_cast<std::uint32_t>(lane));
    if (why == Leaver::moves_on) jumpers_.push_back(tree_.ids(k)[lane]);
  }

  // ---- refitted -----------------------------------------------------------------------------

  /// Joins the tree again with the leaves' bounds as they are; false once boxes have spread so far
  /// that this costs more than a new order would.
  bool refit(Boxes<T> boxes) {
    if (boxes.size() != count_) return false;
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) tree_.set_reach(k, bounds(tree_.leaf(k)));
    tree_.refit_above();
    previous_known_ = false;
    if (visits_ > fresh_visits_ + boxes.size() / 5) return false;
    write_all_pairs();
    reason_ = "refitted: boxes move too far for a list";
    return true;
  }

  // ---- listed -------------------------------------------------------------------------------

  /// From a tree whose leaves hold this frame: margins, the list of leaf pairs, and all pairs.
  void make_list(Boxes<T> boxes, Changes changes) {
    leaves_.assign(tree_.leaves(), Leaf{});
    entries_.clear();
    slots_.resize(boxes.size());
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) {
      leaves_[k].bounds = bounds(tree_.leaf(k));
      tree_.set_reach(k, with_margin(leaves_[k].bounds));
      for (int lane = 0; lane < block_width; ++lane)
        if (const std::uint32_t id = tree_.ids(k)[lane]; id != no_box)
          slots_[id] = k * block_width + static_cast<std::uint32_t>(lane);
    }
    tree_.refit_above();
    tree_.join([&](std::uint32_t a, std::uint32_t b) { add_entry(a, b); });
    work_ = 0;
    for (Entry& entry : entries_) compare(entry, [&](Lanes, int, Lanes) {});
    if (changes == Changes::reported) {
      before_.clear();
      before_.append(pairs_.view());
    }
    write_listed_pairs();
    if (changes == Changes::reported) difference_(before_.view(), pairs_.view(), began_, ended_);
    entries_at_first_ = entries_.size();
    leaves_at_first_ = tree_.leaves();
    excess_ = 0;
    state_ = State::listed;
    full_work_ = work_;
    remember(boxes);
  }
  void add_entry(std::uint32_t a, std::uint32_t b) {
    Entry& entry = entries_.emplace_back();
    entry = {a, b, -std::numeric_limits<double>::infinity(), {}, {}};
  }
  Box<T> with_margin(Box<T> box) const {
    for (int axis = 0; axis < 3; ++axis) box.lo[axis] -= margin_, box.hi[axis] += margin_;
    return box;
  }

  /// Compares the boxes of two leaves again; calls changed(began, row, ended) for rows that did.
  template <class Changed>
  void compare(Entry& entry, Changed&& changed) {
    Slack<T> slack;
    const Block<T>& left = tree_.leaf(entry.a);
    const Loaded<T> right(tree_.leaf(entry.b));
    std::array<std::uint16_t, block_width> rows{};
    ++work_;
    if (entry.a == entry.b) {
      for (int row = 0; row < block_width - 1; ++row) {
        const Lanes after = all_lanes & (all_lanes << (row + 1));
        rows[row] = static_cast<std::uint16_t>(
            right.template overlapping<Contact>(left.box(row), after, slack) & after);
      }
      work_ += block_width;
    } else {
      // Rows that do not reach the other leaf's bounds have at least that much slack.
      Lanes near = Loaded<T>(left).template reaching<Closed>(leaves_[entry.b].bounds, slack);
      work_ += static_cast<std::size_t>(std::popcount(near));
      for (; near; near &= near - 1) {
        const int row = std::countr_zero(near);
        rows[row] = static_cast<std::uint16_t>(
            right.template overlapping<Contact>(left.box(row), all_lanes, slack));
      }
    }
    if (rows != entry.rows) {
      for (int four = 0; four < block_width; four += 4) {
        std::uint64_t differ = four_rows(rows, four) ^ four_rows(entry.rows, four);
        while (differ) {
          const int row = std::countr_zero(differ) / 16;
          const Lanes lanes = static_cast<Lanes>(differ >> (16 * row)) & all_lanes;
          changed(lanes & rows[four + row], four + row, lanes & entry.rows[four + row]);
          differ &= ~(std::uint64_t{all_lanes} << (16 * row));
        }
      }
      entry.rows = rows;
    }
    // Three roundings on the way to the sum, and the slack itself is a rounded difference of T.
    const double travel = leaves_[entry.a].travel + leaves_[entry.b].travel;
    entry.expiry = (travel + static_cast<double>(slack.least()) *
                                 (1 - 2 * static_cast<double>(unit_roundoff<T>))) *
                   (1 - 8 * unit_roundoff<double>);
  }

  static std::uint64_t four_rows(const std::array<std::uint16_t, block_width>& rows, int first) {
    std::uint64_t four;
    std::memcpy(&four, rows.data() + first, sizeof four);
    return four;
  }

  /// Writes the pairs of every entry, each entry's as one segment.
  void write_listed_pairs() {
    PairList& list = pairs_.rewritten();
    for (Entry& entry : entries_) {
      const std::size_t first = list.size();
      Pair* out = list.room_for(block_width * block_width + block_width);
      const std::uint32_t* left = tree_.ids(entry.a);
      const std::uint32_t* right = tree_.ids(entry.b);
      for (int row = 0; row < block_width; ++row)
        if (entry.rows[row]) out = write_pairs(out, left[row], right, entry.rows[row]);
      list.end_at(out);
      entry.segment = {static_cast<std::uint32_t>(first),
                       static_cast<std::uint32_t>(list.size() - first)};
    }
  }

  /// Brings the list up to this frame; false where so many leaves have left their margins that the
  /// list has lost its use.
  bool update_list(Boxes<T> boxes, double step) {
    if (boxes.size() > count_ || !jumpers_.empty()) seat_newcomers(boxes);
    const std::size_t escaped = widen_reaches();
    if (3 * escaped > tree_.leaves() + 64) return false;
    if (escaped) enter_new_neighbours();
    work_ = 0;
    const bool rewrite = compare_expired();
    for (const std::uint32_t slot : emptied_)
      tree_.ids(slot / block_width)[slot % block_width] = no_box;
    emptied_.clear();
    if (rewrite) write_listed_pairs();
    if (settings_.changes == Changes::reported) {
      if (!jumpers_.empty()) cancel_out();
    } else {
      began_.clear();
      ended_.clear();
    }
    reason_ = "listed: boxes move little, pairs of leaves are kept";
    give_up_if_useless(step, rewrite);
    if (state_ == State::listed) renew_if_due(boxes);
    return true;
  }

  /// Boxes that jumped or are new get leaves of their own, among themselves in spatial order.
  void seat_newcomers(Boxes<T> boxes) {
    for (std::size_t id = count_; id < boxes.size(); ++id)
      jumpers_.push_back(static_cast<std::uint32_t>(id));
    std::erase_if(jumpers_, [&](std::uint32_t id) { return id >= boxes.size(); });
    newcomers_.clear();
    for (const std::uint32_t id : jumpers_) newcomers_.push_back(boxes[id]);
    const auto order = newcomers_order_(newcomers_);
    const std::uint32_t first = tree_.leaves();
    tree_.resize_leaves(first +
                        static_cast<std::uint32_t>((order.size() + block_width - 1) / block_width));
    leaves_.resize(tree_.leaves());
    slots_.resize(boxes.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::uint32_t slot = first * block_width + static_cast<std::uint32_t>(k);
      const std::uint32_t id = jumpers_[order[k].id];
      tree_.ids(first)[k] = id;
      slots_[id] = slot;
    }
    for (std::uint32_t k = first; k < tree_.leaves(); ++k) {
      gather(tree_.leaf(k), tree_.ids(k), boxes);
      leaves_[k].moved = leaves_[k].must_compare = true;
      tree_.set_reach(k, nowhere<T>());
      add_entry(k, k);
    }
  }

  /// Gives every leaf that left its reach a new one; how many did.
  std::size_t widen_reaches() {
    escaped_.clear();
    for (std::uint32_t k = 0; k < tree_.leaves(); ++k) {
      Leaf& leaf = leaves_[k];
      if (!leaf.moved) continue;
      leaf.bounds = bounds(tree_.leaf(k));
      const Box<T> reach = tree_.reach(k);
      if (inside(leaf.bounds, reach)) continue;
      leaf.old_reach = reach;
      leaf.reach_changed = true;
      tree_.set_reach(k, with_margin(leaf.bounds));
      escaped_.push_back(k);
    }
    return escaped_.size();
  }
  static bool inside(const Box<T>& a, const Box<T>& b) {
    return a.lo[0] >= b.lo[0] && a.lo[1] >= b.lo[1] && a.lo[2] >= b.lo[2] && a.hi[0] <= b.hi[0] &&
           a.hi[1] <= b.hi[1] && a.hi[2] <= b.hi[2];
  }
  /// Two leaves have an entry if and only if their reaches meet; adds those that this frame's
  /// reaches ask for. Entries whose leaves have parted go when they are next looked at.
  void enter_new_neighbours() {
    tree_.refit_above();
    for (const std::uint32_t a : escaped_)
      tree_.find(tree_.reach(a), [&](std::uint32_t b) {
        if (a == b || (leaves_[b].reach_changed && b < a)) return;
        const Box<T> b_was = leaves_[b].reach_changed ? leaves_[b].old_reach : tree_.reach(b);
        if (!overlap<Closed>(leaves_[a].old_reach, b_was)) add_entry(a, b);
      });
  }

  /// Compares every entry whose slack is used up; whether the list of pairs has to be written anew,
  /// since that is cheaper than to change it in so many places.
  bool compare_expired() {
    // Past this many changes the list is written anew, and they need not be known one by one.
    const std::size_t many = pairs_.size() / 16 + 64;
    const std::size_t recorded =
        settings_.changes == Changes::reported ? std::numeric_limits<std::size_t>::max() : many;
    std::size_t changed = 0, kept = 0;
    ended_segments_.clear();
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      Entry& entry = entries_[e];
      const Leaf &a = leaves_[entry.a], &b = leaves_[entry.b];
      const bool look = a.must_compare | b.must_compare | (a.travel + b.travel >= entry.expiry);
      const bool parted = (a.reach_changed | b.reach_changed) && entry.a != entry.b &&
                          !overlap<Closed>(tree_.reach(entry.a), tree_.reach(entry.b));
      if (look | parted) {
        const std::uint32_t* left = tree_.ids(entry.a);
        const std::uint32_t* right = tree_.ids(entry.b);
        compare(entry, [&](Lanes began, int row, Lanes ended) {
          changed += static_cast<std::size_t>(std::popcount(began) + std::popcount(ended));
          if (changed > recorded) return;
          if (began)
            began_.end_at(write_pairs(began_.room_for(block_width), left[row], right, began));
          if (!ended) return;
          ended_.end_at(write_pairs(ended_.room_for(block_width), left[row], right, ended));
          ended_segments_.resize(ended_.size(), entry.segment);
        });
      }
      if (!parted) {
        if (kept != e) entries_[kept] = entry;
        ++kept;
      }
    }
    entries_.resize(kept);
    if (changed > many || pairs_.displaced() > pairs_.size() / 6 + 64) return true;
    for (std::size_t k = 0; k < ended_.size(); ++k) pairs_.remove(ended_[k], ended_segments_[k]);
    for (const Pair& pair : began_.view()) pairs_.add(pair);
    return false;
  }

  /// A pair that ended in one leaf and began in another, where its box went, did neither.
  void cancel_out() {
    before_.clear();
    before_.append(ended_.view());
    after_.clear();
    after_.append(began_.view());
    difference_(before_.view(), after_.view(), began_, ended_);
  }

  /// Leaves spread as their boxes drift apart. Once that has cost as much as sorting and listing
  /// anew, do so; the pairs stay what they are.
  void renew_if_due(Boxes<T> boxes) {
    const double grown = 1 - static_cast<double>(entries_at_first_) /
                                 static_cast<double>(std::max(entries_.size(), entries_at_first_));
    excess_ += grown * static_cast<double>(work_);
    if (excess_ < 4 * static_cast<double>(boxes.size()) &&
        tree_.leaves() < 2 * leaves_at_first_ + 8)
      return;
    tree_.build(order_(boxes), boxes);
    measure_leaves();
    make_list(boxes, Changes::unreported);
  }

  /// A list of which most has to be compared every frame costs more than joining the tree again,
  /// unless changes have to be reported. Judged over four frames.
  void give_up_if_useless(double step, bool rewritten) {
    // Writing the list anew takes a good half of what comparing everything does.
    used_ +=
        static_cast<double>(work_) / static_cast<double>(full_work_ + 1) + (rewritten ? 0.6 : 0);
    if (++judged_ < 4) return;
    if (used_ > 1.1 * judged_ && settings_.changes == Changes::unreported) {
      step_given_up_ = step;
      state_ = State::loose;
      previous_known_ = false;
    }
    used_ = 0, judged_ = 0;
  }

  MethodSettings settings_;
  State state_ = State::empty;
  std::size_t count_ = 0;  ///< boxes of the last frame
  std::string_view reason_;
  SpatialOrder<T> order_, newcomers_order_;
  BlockTree<T> tree_;
  KeptPairs pairs_;
  double leaf_size_ = 0;  ///< mean extent of a leaf after sorting
  std::size_t visits_ = 0, fresh_visits_ = 0;

  std::vector<Entry> entries_;
  std::vector<Leaf> leaves_;
  T margin_ = 0;
  std::size_t entries_at_first_ = 0, work_ = 0;
  std::uint32_t leaves_at_first_ = 0;
  double excess_ = 0;
  std::size_t full_work_ = 0;
  double used_ = 0;
  int judged_ = 0;
  double step_given_up_ = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> escaped_;

  std::vector<std::uint32_t> slots_;  ///< of each box: leaf times sixteen plus lane
  std::vector<Box<T>> previous_, newcomers_;
  bool previous_known_ = false;
  std::vector<std::uint32_t> jumpers_, emptied_, moved_leaves_;
  std::vector<T> largest_;

  PairList began_, ended_, before_, after_;
  std::vector<PairList> shares_;
  std::vector<Segment> ended_segments_;
  PairDifference difference_;
};

}  // namespace bvlab
