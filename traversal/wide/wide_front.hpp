// SPDX-License-Identifier: BSD-3-Clause
/// The front of two trees whose children are stored side by side. An entry is an expansion: the
/// pair of nodes of one step, which tests sixteen pairs of their children or fewer, and a mask of
/// the lanes that were opened. The closed lanes are the culled pairs, and pairs of leaves. An
/// opened lane leads to the one entry that was made for its pair.
///
/// A list retests the closed lanes of all entries. Margins also keep the least gap of each entry's
/// closed lanes, with the sphere at which it was measured (measured_gaps.hpp); there, a pair whose
/// triangles were tested becomes an entry of its own, with the least margin of its verdicts.
///
/// Law: every pair of triangles lies below a closed lane of exactly one entry, or in one entry of
/// triangles. An entry comes after the one that opened it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "traversal/measured_gaps.hpp"
#include "traversal/wide/work_queue.hpp"

namespace bvlab {

class WideFront {
 public:
  /// In place of the number of an entry: a step or triangles that are no entry yet; and triangles
  /// that are tested before all others, whatever entry they belong to.
  static constexpr std::size_t none = static_cast<std::size_t>(-1), witness = none - 1;

  /// A step; the triangles of two leaves, or of one and a leaf; the same, of which near pairs have
  /// verdicts that are entries; the verdict on two triangles, by their numbers in the trees.
  enum class Kind : std::uint8_t { step, triangles, sorted, verdict, gone };
  /// Of a test of an entry, in steps.
  static constexpr float cost(Kind kind) {
    return kind == Kind::step ? 1 : kind == Kind::triangles ? 2 : 3;
  }
  struct Entry {
    NodePair pair;           ///< of a step, or of tested triangles
    LaneOfEntry from;        ///< the lane that was opened for it; no_lane: the roots
    std::uint16_t opened;    ///< the opened lanes
    std::uint16_t rising;    ///< those of them that the next run tests, and closes if apart
    Kind kind;
    std::uint8_t wait;       ///< triangles: tests without margins; a step: runs until it may rise
    std::uint8_t next_wait;  ///< of a step
  };
  /// Two triangles of an entry that share a point, until its gap is used up.
  struct Hit {
    std::uint32_t entry;
    NodePair triangles;  ///< by their indices in their meshes
  };

  std::size_t size() const { return entries_.size(); }
  bool is_complete() const { return complete_at_ > 0; }
  void clear() {
    entries_.clear(), gaps_.clear(), hits.clear(), complete_at_ = gone_ = sorted_ = 0;
  }
  /// The first run is over. A front whose roots were not opened stays incomplete.
  void complete() {
    complete_at_ = entries_.size(), cost_of_rebuild_ = 0;
    for (const Entry& entry : entries_) cost_of_rebuild_ += cost(entry.kind);
  }
  float cost_of_rebuild() const { return cost_of_rebuild_; }
  /// Whether the front is so much longer than when it was complete that it should be rebuilt.
  bool overgrown() const { return entries_.size() > 4 * complete_at_ + 16; }

  Entry& operator[](std::size_t i) { return entries_[i]; }
  /// Verdicts on near triangles of entry i are about to be entries.
  void sort(std::size_t i) {
    sorted_ += entries_[i].kind != Kind::sorted;
    entries_[i].kind = Kind::sorted;
  }
  /// The number of entries of which that is so.
  std::size_t sorted() const { return sorted_; }
  /// Adds an entry; returns its number.
  std::size_t add(const OpenPair& pair, Kind kind, std::uint64_t opened = 0) {
    entries_.push_back({pair, pair.from, static_cast<std::uint16_t>(opened), 0, kind, 0, 1});
    return entries_.size() - 1;
  }
  bool is_open(LaneOfEntry lane) const { return entries_[lane / 16].opened >> lane % 16 & 1; }
  void open(LaneOfEntry lane) { entries_[lane / 16].opened |= bit(lane); }
  void close(LaneOfEntry lane) {
    entries_[lane / 16].opened &= static_cast<std::uint16_t>(~bit(lane));
  }

  /// Closed entries may rise: where both bodies have come apart, a lane that was opened for an
  /// entry without opened lanes is tested again after 1, 2, 4, ... 16 runs.
  void propose(std::size_t i) {
    Entry& entry = entries_[i];
    if (entry.opened != 0 || entry.from == no_lane) return;
    if (entry.wait > 1) {
      --entry.wait;
      return;
    }
    entries_[entry.from / 16].rising |= bit(entry.from);
    entry.wait = entry.next_wait;
    entry.next_wait = std::min<std::uint8_t>(2 * entry.next_wait, 16);
  }
  /// Removes entry i, whose lane was closed.
  void drop(std::size_t i) { entries_[i].kind = Kind::gone, ++gone_; }
  /// Closes up where a quarter of the entries are gone. Not for fronts with gaps.
  void close_up() {
    if (4 * gone_ <= entries_.size()) return;
    std::vector<std::uint32_t> number(entries_.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i].kind == Kind::gone) continue;
      Entry entry = entries_[i];
      if (entry.from != no_lane) entry.from = 16 * number[entry.from / 16] + entry.from % 16;
      number[i] = static_cast<std::uint32_t>(kept);
      entries_[kept++] = entry;
    }
    entries_.resize(kept);
    gone_ = 0;
  }

  MeasuredGaps& gaps() { return gaps_; }
  const MeasuredGaps& gaps() const { return gaps_; }

  std::vector<Hit> hits;  ///< of entries whose gaps last

 private:
  static std::uint16_t bit(LaneOfEntry lane) { return static_cast<std::uint16_t>(1u << lane % 16); }

  std::vector<Entry> entries_;
  MeasuredGaps gaps_;
  std::size_t complete_at_ = 0, gone_ = 0, sorted_ = 0;
  float cost_of_rebuild_ = 0;
};

/// Pauses of the front: traversals without one after a front that wore out.
class FrontPause {
 public:
  /// Counts one traversal; returns whether it may keep a front.
  bool over() { return remaining_ == 0 || (--remaining_, false); }
  /// Called when a front was retested: one that wore out starts a pause, longer each time.
  void begin(bool worn) {
    if (worn) remaining_ = next_;
    next_ = worn ? std::min(4 * next_, longest) : shortest;
  }

 private:
  static constexpr int shortest = 16, longest = 256;
  int remaining_ = 0, next_ = shortest;
};

}  // namespace bvlab
