// SPDX-License-Identifier: BSD-3-Clause
/// Tracks the pairs of bodies that are near each other: a broad phase over boxes around the bodies,
/// and a slot for each chosen pair whose boxes overlap. A pair keeps its slot from the frame in
/// which its boxes begin to overlap to the frame in which they part; slots are reused.
///
/// A frame costs the broad phase and O(m + q), for m bodies that moved and q pairs that involve
/// them; O(slots) where over a quarter of the bodies moved. A body is in the scene from its first
/// move until it is taken out.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "broadphase/settings.hpp"
#include "hierarchies/geometry/morton.hpp"
#include "hierarchies/geometry/radix_sort.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "traversal/pair_choice.hpp"
#include "traversal/rotated_mesh_box.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

/// Method is a broad phase over float boxes that reports changes.
template <class Method>
class NearPairs {
 public:
  /// `mesh(i)` returns body i's mesh, which must outlive this.
  template <class Mesh>
  NearPairs(std::size_t objects, int threads, Mesh&& mesh)
      : threads_(threads),
        method_(MethodSettings{.changes = Changes::reported, .threads = threads}) {
    poses_.reserve(objects), boxes_.reserve(objects), neighbours_.reserve(objects);
    moved_.reserve(objects), present_.reserve(objects), movers_.reserve(objects);
    for (std::size_t i = 0; i < objects; ++i) add(mesh(i));
  }

  /// Adds a body, which is not in the scene before its first move. Returns its index.
  std::uint32_t add(const TriangleMesh& mesh) {
    const std::size_t i = box_of_.size();
    const auto [at, fresh] = known_.try_emplace(&mesh, mesh_boxes_.size());
    if (fresh) mesh_boxes_.emplace_back(mesh);
    box_of_.push_back(at->second);
    poses_.emplace_back(), boxes_.push_back(outside(i)), neighbours_.emplace_back();
    moved_.push_back(Moved::no), present_.push_back(0);
    // So that `move` never throws.
    if (movers_.capacity() <= i) movers_.reserve(2 * (i + 1));
    return static_cast<std::uint32_t>(i);
  }

  /// Only these pairs get slots. To be called before the first update.
  void choose(PairFilter chosen) { chosen_ = std::move(chosen); }

  void move(std::uint32_t object, const Pose& pose) {
    if (present_[object] && poses_[object] == pose) return;
    poses_[object] = pose, present_[object] = 1;
    if (moved_[object] == Moved::no) movers_.push_back(object);
    moved_[object] = Moved::yes;
  }
  /// Takes a body out of the scene until it is moved again.
  void take_out(std::uint32_t object) {
    if (!present_[object]) return;
    present_[object] = 0;
    if (moved_[object] == Moved::no) movers_.push_back(object);
    moved_[object] = Moved::yes;
  }

  /// Finds the pairs whose boxes overlap. Calls `part(slot)` for each pair that no longer overlaps,
  /// then `meet(slot, pair)` for each that begins to; both, at last, for each pair of a body that
  /// was taken out. Before them, calls `set_pose(object)`, on any thread, for every body of the
  /// scene that has moved.
  template <class SetPose, class Meet, class Part>
  void update(SetPose&& set_pose, Meet&& meet, Part&& part) {
    due_.clear();
    if (movers_.empty()) return;
    if (!has_origin_) choose_origin();
    threads_.share_out(movers_.size(), 128, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t m = begin; m < end; ++m) {
        const std::uint32_t i = movers_[m];
        boxes_[i] = present_[i] ? mesh_boxes_[box_of_[i]](poses_[i], origin_) : outside(i);
        if (present_[i]) set_pose(i);
      }
    });
    if constexpr (requires { method_.update(boxes_, movers()); })
      method_.update(boxes_, movers());
    else
      method_.overlapping(boxes_);
    const PairChanges changes = method_.changes();
    for (std::size_t k = 0; k < changes.ended.size(); ++k) {
      fetch_ahead(changes.ended, k);
      const auto& [i, j] = changes.ended[k];
      if (!chosen_({i, j})) continue;
      const std::uint32_t slot = slot_of(i, j);
      part(slot);
      end(slot);
    }
    for (std::size_t k = 0; k < changes.began.size(); ++k) {
      fetch_ahead(changes.began, k);
      const auto& [i, j] = changes.began[k];
      if (!chosen_({i, j})) continue;
      meet(begin({i, j}), ObjectPair{i, j});
    }
    // Boxes clipped to the range of float overlap even removed bodies; such pairs start afresh.
    for (const auto i : movers_)
      if (!present_[i])
        for (const auto& [other, slot] : neighbours_[i]) part(slot), meet(slot, near_[slot].pair);
    find_due();
  }

  /// After `update`: the slots of pairs of which at least one body has moved.
  std::span<const std::uint32_t> due() const { return due_; }
  /// The bodies that have moved.
  std::span<const std::uint32_t> movers() const { return movers_; }
  /// Forgets which bodies have moved.
  void settle() {
    for (const auto i : movers_) moved_[i] = Moved::no;
    movers_.clear();
  }

  Threads& threads() { return threads_; }
  std::span<const Pose> poses() const { return poses_; }
  /// The origin relative to which volumes are posed into the world.
  const Vec3<double>& origin() const { return origin_; }
  std::size_t slots() const { return near_.size(); }
  bool taken(std::uint32_t slot) const { return near_[slot].taken; }
  /// The number of pairs whose boxes overlap.
  std::size_t size() const { return near_.size() - free_.size(); }

 private:
  enum class Moved : std::uint8_t { no, yes, done };  ///< done: its pairs are due
  struct Near {
    ObjectPair pair;
    std::uint32_t index_at_i, index_at_j;  ///< in the neighbours of i and j
    bool taken;
  };
  struct Neighbour {
    std::uint32_t other, slot;
  };

  /// A far point, its own for each removed body. Only boxes clipped to float's range overlap it.
  static Box<float> outside(std::size_t i) {
    constexpr float far = std::numeric_limits<float>::max() / 4;
    constexpr std::size_t cells = 1 << 11;
    Box<float> box;
    for (int axis = 0; axis < 3; ++axis, i /= cells)
      box.lo[axis] = box.hi[axis] = far * (1 + static_cast<float>(i % cells) / cells);
    return box;
  }

  /// Makes the centre of the bodies the origin. Float boxes and volumes are posed relative to it,
  /// so that their precision does not depend on where in the world the bodies are.
  void choose_origin() {
    Eigen::AlignedBox3d all;
    for (const auto i : movers_)
      if (present_[i]) all.extend(mesh_boxes_[box_of_[i]].mesh_origin(poses_[i]));
    if (all.isEmpty()) return;
    origin_ = all.min() / 2 + all.max() / 2;
    has_origin_ = true;
  }

  /// Collects the slots of the movers' pairs, each once. Where more than a quarter of the bodies
  /// have moved, it scans all slots; else the movers' lists of neighbours, with movers along a
  /// Morton curve, so that pairs share data in the cache.
  void find_due() {
    if (4 * movers_.size() > boxes_.size()) {
      for (std::uint32_t slot = 0; slot < near_.size(); ++slot) {
        const auto [i, j] = near_[slot].pair;
        const bool moved = (moved_[i] != Moved::no) + (moved_[j] != Moved::no) > 0;
        if (near_[slot].taken & moved & present_[i] & present_[j]) due_.push_back(slot);
      }
      return;
    }
    Eigen::AlignedBox3d all;
    for (const auto i : movers_) all.extend(poses_[i].translation);
    ordered_.clear();
    for (const auto i : movers_) {
      moved_[i] = Moved::yes;  // it is `done` if an exception ended the last frame before `settle`
      const std::uint64_t code = morton_code(poses_[i].translation, all);
      ordered_.push_back({static_cast<std::uint32_t>(code >> (63 - code_bits)), i});
    }
    radix_sort(ordered_, spare_, code_bits);
    for (const auto& [code, i] : ordered_) {
      // A pair whose bodies have both moved is listed once.
      if (present_[i])
        for (const auto& [other, slot] : neighbours_[i])
          if (moved_[other] != Moved::done && present_[other]) due_.push_back(slot);
      moved_[i] = Moved::done;
    }
  }
  static constexpr int code_bits = 21;  ///< 128 cells a side are enough for an order

  /// Prefetches the lists of neighbours of pairs to come, which lie anywhere in memory: first the
  /// list itself, then its elements.
  void fetch_ahead(std::span<const Pair> pairs, std::size_t k) const {
    if (k + 16 < pairs.size())
      for (const auto i : {pairs[k + 16].i, pairs[k + 16].j})
        __builtin_prefetch(&neighbours_[i], 1);
    if (k + 8 < pairs.size())
      for (const auto i : {pairs[k + 8].i, pairs[k + 8].j})
        __builtin_prefetch(neighbours_[i].data(), 1);
  }

  std::uint32_t begin(const ObjectPair& pair) {
    auto &of_i = neighbours_[pair.i], &of_j = neighbours_[pair.j];
    const Near fresh{pair, static_cast<std::uint32_t>(of_i.size()),
                     static_cast<std::uint32_t>(of_j.size()), true};
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
    return slot;
  }

  std::uint32_t slot_of(std::uint32_t i, std::uint32_t j) const {
    const bool i_has_fewer = neighbours_[i].size() <= neighbours_[j].size();
    const auto& few = neighbours_[i_has_fewer ? i : j];
    const std::uint32_t other = i_has_fewer ? j : i;
    return std::find_if(few.begin(), few.end(), [&](const auto& n) { return n.other == other; })
        ->slot;
  }

  void end(std::uint32_t slot) {
    Near& gone = near_[slot];
    remove(gone.pair.i, gone.index_at_i);
    remove(gone.pair.j, gone.index_at_j);
    gone.taken = false;
    free_.push_back(slot);
  }

  /// Removes one element of a body's list of neighbours; the last element takes its index.
  void remove(std::uint32_t object, std::uint32_t index) {
    auto& list = neighbours_[object];
    list[index] = list.back();
    list.pop_back();
    if (index == list.size()) return;
    Near& moved = near_[list[index].slot];
    (moved.pair.i == object ? moved.index_at_i : moved.index_at_j) = index;
  }

  Threads threads_;
  Method method_;
  PairFilter chosen_;
  std::vector<RotatedMeshBox> mesh_boxes_;  // one for each mesh
  std::unordered_map<const TriangleMesh*, std::uint32_t> known_;  // where each mesh's box is
  std::vector<std::uint32_t> box_of_;       // for each body, the index of its box there
  std::vector<Pose> poses_;
  std::vector<Box<float>> boxes_;
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<Near> near_;
  std::vector<std::uint32_t> free_;                    // free slots
  std::vector<std::uint32_t> movers_;                  // since the last update
  std::vector<Keyed<std::uint32_t>> ordered_, spare_;  // movers, with their Morton codes
  std::vector<std::uint32_t> due_;
  std::vector<Moved> moved_;
  std::vector<std::uint8_t> present_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool has_origin_ = false;
};

}  // namespace bvlab
