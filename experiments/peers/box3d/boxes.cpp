// SPDX-License-Identifier: BSD-3-Clause
/// box3d's dynamic tree, as its broad phase uses it: wide boxes in the tree; a box that leaves its
/// wide one is enlarged, what was enlarged is rebuilt, and those boxes ask the tree. Pairs of wide
/// boxes are kept; those of a box that moved are compared once more with the boxes themselves.
#include <box3d/collision.h>

#include <algorithm>
#include <cstring>

#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/pair_slots.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

class Box3d final : public BoxPeer {
 public:
  ~Box3d() override { leave(); }

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    if (boxes.size() != last_.size() || !made_) return enter(boxes);
    moved_.clear();
    for (std::uint32_t k = 0; k < boxes.size(); ++k)
      if (std::memcmp(&boxes[k], &last_[k], sizeof boxes[k]) != 0) {
        last_[k] = boxes[k];
        moved_.push_back(k);
      }
    return move(boxes, moved_);
  }

  std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t> moved) override {
    return boxes.size() != last_.size() || !made_ ? enter(boxes) : move(boxes, moved);
  }
  bool takes_moved() const override { return true; }

 private:
  static constexpr std::uint32_t nowhere = 0xffffffffu;

  /// A pair whose wide boxes overlap, and its place in the list.
  struct Candidate {
    Pair pair;
    std::uint32_t slot;
  };

  static b3AABB theirs(const Box<float>& box) {
    return {{box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}};
  }
  static Box<float> widened(Box<float> box) {
    for (int axis = 0; axis < 3; ++axis) {
      const float margin = 0.1f * (box.hi[axis] - box.lo[axis]);
      box.lo[axis] -= margin, box.hi[axis] += margin;
    }
    return box;
  }
  static bool holds(const Box<float>& wide, const Box<float>& box) {
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      inside &= box.lo[axis] >= wide.lo[axis] && box.hi[axis] <= wide.hi[axis];
    return inside;
  }

  std::span<const Pair> enter(Boxes<float> boxes) {
    leave();
    const std::size_t count = boxes.size();
    tree_ = b3DynamicTree_Create(static_cast<int>(count));
    made_ = true;
    last_.assign(boxes.begin(), boxes.end());
    wide_.resize(count), proxies_.resize(count);
    of_.assign(count, {});
    frame_ = 1;
    escaped_in_.assign(count, frame_);
    for (std::uint32_t k = 0; k < count; ++k) {
      wide_[k] = widened(boxes[k]);
      proxies_[k] = b3DynamicTree_CreateProxy(&tree_, theirs(wide_[k]), 1, k);
    }
    b3DynamicTree_Rebuild(&tree_, true);
    for (std::uint32_t k = 0; k < count; ++k) ask(k);
    for (std::uint32_t k = 0; k < candidates_.size(); ++k) compare(k, boxes);
    return pairs_.view();
  }

  std::span<const Pair> move(Boxes<float> boxes, std::span<const std::uint32_t> moved) {
    ++frame_;
    escaped_.clear();
    for (const std::uint32_t k : moved) {
      if (holds(wide_[k], boxes[k])) continue;
      const bool far = !overlap<Closed>(wide_[k], boxes[k]);
      wide_[k] = widened(boxes[k]);
      if (far)
        b3DynamicTree_MoveProxy(&tree_, proxies_[k], theirs(wide_[k]));
      else
        b3DynamicTree_EnlargeProxy(&tree_, proxies_[k], theirs(wide_[k]));
      escaped_in_[k] = frame_;
      escaped_.push_back(k);
    }
    if (!escaped_.empty()) b3DynamicTree_Rebuild(&tree_, false);
    for (const std::uint32_t k : escaped_) forget_what_parted(k);
    for (const std::uint32_t k : escaped_) ask(k);
    for (const std::uint32_t k : moved)
      for (const std::uint32_t candidate : of_[k]) compare(candidate, boxes);
    return pairs_.view();
  }

  struct Asking {
    Box3d* peer;
    std::uint32_t box;
  };
  static bool found(int, std::uint64_t other, void* asking) {
    const auto& [peer, box] = *static_cast<Asking*>(asking);
    peer->meet(box, static_cast<std::uint32_t>(other));
    return true;
  }
  void ask(std::uint32_t box) {
    Asking asking{this, box};
    b3DynamicTree_Query(&tree_, theirs(wide_[box]), 1, false, found, &asking);
  }
  void meet(std::uint32_t box, std::uint32_t other) {
    // Of two that ask, the one with the smaller index is heard.
    if (other == box || (escaped_in_[other] == frame_ && other < box)) return;
    const Pair pair = ordered(box, other);
    if (known_.find(pair) != PairSlots::none) return;
    auto place = static_cast<std::uint32_t>(candidates_.size());
    if (free_.empty()) {
      candidates_.push_back({});
    } else {
      place = free_.back();
      free_.pop_back();
    }
    candidates_[place] = {pair, nowhere};
    known_.put(pair, place);
    of_[pair.i].push_back(place);
    of_[pair.j].push_back(place);
  }

  void compare(std::uint32_t place, Boxes<float> boxes) {
    Candidate& candidate = candidates_[place];
    const bool hit = overlap<Closed>(boxes[candidate.pair.i], boxes[candidate.pair.j]);
    if (hit == (candidate.slot != nowhere)) return;
    if (!hit) return drop(candidate);
    candidate.slot = static_cast<std::uint32_t>(pairs_.size());
    pairs_.push(candidate.pair);
    if (from_.size() < pairs_.size()) from_.resize(pairs_.size());
    from_[candidate.slot] = place;
  }
  void drop(Candidate& candidate) {
    const auto last = static_cast<std::uint32_t>(pairs_.size() - 1);
    if (candidate.slot != last) {
      pairs_[candidate.slot] = pairs_[last];
      from_[candidate.slot] = from_[last];
      candidates_[from_[last]].slot = candidate.slot;
    }
    pairs_.resize_down(last);
    candidate.slot = nowhere;
  }
  void forget_what_parted(std::uint32_t box) {
    auto& mine = of_[box];
    for (std::size_t k = 0; k < mine.size();) {
      const std::uint32_t place = mine[k];
      Candidate& candidate = candidates_[place];
      const auto [i, j] = candidate.pair;
      if (overlap<Closed>(wide_[i], wide_[j])) {
        ++k;
        continue;
      }
      if (candidate.slot != nowhere) drop(candidate);
      known_.erase(candidate.pair);
      auto& others = of_[i == box ? j : i];
      *std::find(others.begin(), others.end(), place) = others.back();
      others.pop_back();
      free_.push_back(place);
      mine[k] = mine.back();
      mine.pop_back();
    }
  }

  void leave() {
    if (made_) b3DynamicTree_Destroy(&tree_);
    made_ = false;
    candidates_.clear(), free_.clear(), known_.clear(), pairs_.clear();
  }

  b3DynamicTree tree_{};
  bool made_ = false;
  std::vector<Box<float>> last_, wide_;
  std::vector<int> proxies_;
  std::uint32_t frame_ = 0;
  std::vector<std::uint32_t> moved_, escaped_, escaped_in_;
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> free_, from_;  ///< unused candidates; of each pair, its candidate
  std::vector<std::vector<std::uint32_t>> of_;
  PairSlots known_;
  PairList pairs_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "box3d") return std::make_unique<Box3d>();
  return nullptr;
}

}  // namespace

BoxLibrary box3d_boxes() { return {make, {"box3d"}}; }

}  // namespace bvlab
