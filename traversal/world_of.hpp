// SPDX-License-Identifier: BSD-3-Clause
/// Many bodies, of which only pairs that are near each other are asked, and only when one of the
/// two has moved: a broad phase over the bodies' boxes in front, a strategy for each pair that it
/// reports, forgotten when the pair parts.
///
/// A frame costs O(m + q) plus what the broad phase takes, for m bodies that moved and q pairs near
/// them; what stays costs nothing, and what nobody came near is not even made: a body gets room for
/// its posed volumes when the first pair asks for it.
///
/// Pairs stand in slots. A pair keeps its slot from the frame in which its boxes meet to the one in
/// which they part; slots are used again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "broadphase/settings.hpp"
#include "hierarchies/geometry/morton.hpp"
#include "traversal/bodies.hpp"
#include "traversal/rotated_mesh_box.hpp"

namespace bvlab {

/// Over any kind of bodies: `Bodies` or what offers the same. Method is a broad phase over float
/// boxes that reports changes.
template <class BodySet, class Strategy, class Method>
class WorldOf {
 public:
  /// `bodies` makes the BodySet.
  template <class Made>
  WorldOf(Made&& bodies, const Strategy& strategy)
      : bodies_(std::forward<Made>(bodies)),
        prototype_(strategy),
        method_(MethodSettings{.changes = Changes::reported}),
        poses_(bodies_.size()),
        boxes_(bodies_.size()),
        neighbours_(bodies_.size()),
        moved_(bodies_.size(), Moved::no) {
    std::unordered_map<const TriangleMesh*, std::uint32_t> known;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const auto [at, fresh] = known.try_emplace(&bodies_.mesh(i), known.size());
      if (fresh) mesh_boxes_.emplace_back(bodies_.mesh(i));
      box_of_.push_back(at->second);
    }
  }

  /// Says where a body is from now on. Before the first update every body needs a pose.
  void move(std::uint32_t object, const Pose& pose) {
    if (placed_ && poses_[object] == pose) return;
    poses_[object] = pose;
    if (moved_[object] == Moved::no) movers_.push_back(object);
    moved_[object] = Moved::yes;
  }

  /// Asks every pair whose boxes meet and of which a body has moved since the last update:
  /// `ask(pair)` makes the query, `take(slot, pair, query)` gets it back with its answer. All other
  /// pairs have the answers they had. `leave(slot)` is told before of pairs whose boxes have
  /// parted: nothing of the two bodies meets.
  template <class Counter, class Ask, class Take, class Leave>
  void update(Counter& counter, Ask&& ask, Take&& take, Leave&& leave) {
    if (!placed_) origin_ = middle_of(poses_);
    placed_ = true;
    for (const auto i : movers_) boxes_[i] = mesh_boxes_[box_of_[i]](poses_[i], origin_);
    if (!movers_.empty()) find_near(leave);
    order_movers();
    asked_ = 0;
    for (const auto i : movers_) {
      for (const auto& [other, slot] : neighbours_[i]) {
        // A pair of which both have moved is asked once.
        if (moved_[other] == Moved::done) continue;
        const ObjectPair& pair = near_[slot].pair;
        auto query = ask(pair);
        for (const auto k : {pair.i, pair.j}) bodies_.move(k, poses_[k], origin_);
        near_[slot].strategy.run(bodies_.pair(pair, query, counter));
        take(slot, pair, query);
        ++asked_;
      }
      moved_[i] = Moved::done;
    }
    for (const auto i : movers_) moved_[i] = Moved::no;
    movers_.clear();
  }

  std::size_t objects() const { return bodies_.size(); }
  /// Pairs whose boxes meet.
  std::size_t near() const { return near_.size() - free_.size(); }
  /// Pairs that the last update asked.
  std::size_t asked() const { return asked_; }
  /// The entries of all fronts together; looks at every pair.
  std::size_t front_size() const {
    std::size_t sum = 0;
    for (const auto& each : near_)
      if (each.taken) sum += each.strategy.front_size();
    return sum;
  }

 private:
  enum class Moved : std::uint8_t { no, yes, done };  ///< done: its pairs have been asked
  struct Near {
    ObjectPair pair;
    std::uint32_t place_of_i, place_of_j;  ///< in the lists of neighbours
    bool taken;
    Strategy strategy;
  };
  struct Neighbour {
    std::uint32_t other, slot;
  };

  /// Neighbours one after the other: what one pair has posed is still in the cache when the next
  /// one asks for it.
  void order_movers() {
    Eigen::AlignedBox3d all;
    for (const auto i : movers_) all.extend(poses_[i].translation);
    ordered_.clear();
    for (const auto i : movers_) ordered_.emplace_back(morton_code(poses_[i].translation, all), i);
    std::sort(ordered_.begin(), ordered_.end());
    std::transform(ordered_.begin(), ordered_.end(), movers_.begin(),
                   [](const auto& coded) { return coded.second; });
  }

  template <class Leave>
  void find_near(Leave&& leave) {
    method_.overlapping(boxes_);
    const PairChanges changes = method_.changes();
    for (const auto& [i, j] : changes.ended) {
      const std::uint32_t slot = slot_of(i, j);
      leave(slot);
      part(slot);
    }
    for (const auto& [i, j] : changes.began) meet({i, j});
  }

  void meet(const ObjectPair& pair) {
    auto &of_i = neighbours_[pair.i], &of_j = neighbours_[pair.j];
    const Near fresh{pair, static_cast<std::uint32_t>(of_i.size()),
                     static_cast<std::uint32_t>(of_j.size()), true, prototype_};
    std::uint32_t slot = static_cast<std::uint32_t>(near_.size());
    if (free_.empty()) {
      near_.push_back(fresh);
    } else {
      slot = free_.back();
      free_.pop_back();
      near_[slot] = fresh;
    }
    of_i.push_back({pair.j, slot});
    of_j.push_back({pair.i, slot});
  }

  std::uint32_t slot_of(std::uint32_t i, std::uint32_t j) const {
    const bool i_has_fewer = neighbours_[i].size() <= neighbours_[j].size();
    const auto& few = neighbours_[i_has_fewer ? i : j];
    const std::uint32_t other = i_has_fewer ? j : i;
    return std::find_if(few.begin(), few.end(), [&](const auto& n) { return n.other == other; })
        ->slot;
  }

  void part(std::uint32_t slot) {
    Near& gone = near_[slot];
    remove(gone.pair.i, gone.place_of_i);
    remove(gone.pair.j, gone.place_of_j);
    gone.taken = false;
    gone.strategy = prototype_;
    free_.push_back(slot);
  }

  /// The last one of the body's neighbours takes the place.
  void remove(std::uint32_t object, std::uint32_t place) {
    auto& list = neighbours_[object];
    list[place] = list.back();
    list.pop_back();
    if (place == list.size()) return;
    Near& moved = near_[list[place].slot];
    (moved.pair.i == object ? moved.place_of_i : moved.place_of_j) = place;
  }

  BodySet bodies_;
  Strategy prototype_;
  Method method_;
  std::vector<RotatedMeshBox> mesh_boxes_;  // one for each mesh
  std::vector<std::uint32_t> box_of_;       // which of them is a body's
  std::vector<Pose> poses_;
  std::vector<Box<float>> boxes_;
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<Near> near_;
  std::vector<std::uint32_t> free_;                               // slots that no pair has
  std::vector<std::uint32_t> movers_;                             // since the last update
  std::vector<std::pair<std::uint64_t, std::uint32_t>> ordered_;  // they, with their codes
  std::vector<Moved> moved_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  std::size_t asked_ = 0;
  bool placed_ = false;
};

/// Which pairs touch, as a list that changes only where answers do.
class TouchingPairs {
 public:
  void put(std::uint32_t slot, const ObjectPair& pair, bool touching) {
    if (slot >= place_.size()) place_.resize(slot + 1, none);
    if (touching == (place_[slot] != none)) return;
    if (!touching) return drop(slot);
    place_[slot] = static_cast<std::uint32_t>(pairs_.size());
    pairs_.push_back(pair);
    slots_.push_back(slot);
  }
  void drop(std::uint32_t slot) {
    if (slot >= place_.size() || place_[slot] == none) return;
    const std::uint32_t place = place_[slot];
    pairs_[place] = pairs_.back(), slots_[place] = slots_.back();
    place_[slots_[place]] = place;
    place_[slot] = none;
    pairs_.pop_back(), slots_.pop_back();
  }
  /// In any order.
  std::span<const ObjectPair> pairs() const { return pairs_; }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> place_;  // of each slot, in the two others
  std::vector<ObjectPair> pairs_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace bvlab
