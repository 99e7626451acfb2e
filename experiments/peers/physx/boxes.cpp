// SPDX-License-Identifier: BSD-3-Clause
/// PhysX's broad phases, alone (PxCreateBroadPhase): automatic box pruning, its parallel version
/// and incremental sweep and prune. They tell which pairs began and ended, so the list of all is
/// kept here, which is part of the time. They are told which boxes moved; where the adapter is not
/// told, it compares the boxes with those of the frame before. No task is given, so the parallel
/// version runs on one thread.
#include <PxBroadPhase.h>

#include <cstring>

#include "broadphase/structures/pair_list.hpp"
#include "broadphase/structures/pair_slots.hpp"
#include "experiments/peers/box_peers.hpp"
#include "experiments/peers/physx/foundation.hpp"

namespace bvlab {
namespace {

class Physx final : public BoxPeer {
 public:
  explicit Physx(physx::PxBroadPhaseType::Enum type) : type_(type) {
    physx_foundation();
    begin();
  }

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    const bool enters = boxes.size() != count_;
    if (enters) enter(boxes.size());
    changed_.clear();
    for (std::uint32_t k = 0; k < boxes.size(); ++k)
      if (enters || std::memcmp(&bounds_[k], &boxes[k], sizeof boxes[k]) != 0) change(k, boxes[k]);
    return update_with(enters);
  }

  std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t> moved) override {
    if (boxes.size() != count_) return overlapping(boxes);
    changed_.clear();
    for (const std::uint32_t k : moved) change(k, boxes[k]);
    return update_with(false);
  }
  bool takes_moved() const override { return true; }

 private:
  struct Release {
    void operator()(physx::PxBroadPhase* phase) const { phase->release(); }
  };

  void change(std::uint32_t k, const Box<float>& box) {
    // A box here is laid out as theirs.
    static_assert(sizeof(physx::PxBounds3) == sizeof(Box<float>));
    std::memcpy(static_cast<void*>(&bounds_[k]), &box, sizeof box);
    changed_.push_back(k);
  }
  std::span<const Pair> update_with(bool enters) {
    if (changed_.empty()) return pairs_.view();
    const auto many = static_cast<physx::PxU32>(changed_.size());
    phase_->update({enters ? changed_.data() : nullptr, enters ? many : 0,
                    enters ? nullptr : changed_.data(), enters ? 0 : many, nullptr, 0,
                    bounds_.data(), groups_.data(), distances_.data(),
                    static_cast<physx::PxU32>(bounds_.size())});
    physx::PxBroadPhaseResults results;
    phase_->fetchResults(results);
    for (physx::PxU32 k = 0; k < results.mNbDeletedPairs; ++k) drop(results.mDeletedPairs[k]);
    for (physx::PxU32 k = 0; k < results.mNbCreatedPairs; ++k) add(results.mCreatedPairs[k]);
    return pairs_.view();
  }

  /// Makes the broad phase, before the first frame's clock starts.
  void begin() { phase_.reset(physx::PxCreateBroadPhase(physx::PxBroadPhaseDesc(type_))); }
  /// Arrays have one entry more than there are boxes: it loads four numbers where three are.
  void enter(std::size_t count) {
    if (count_ > 0) begin();
    count_ = count;
    bounds_.assign(count + 1, physx::PxBounds3::empty());
    distances_.assign(count + 1, 0);
    groups_.resize(count + 1);
    for (std::size_t k = 0; k < groups_.size(); ++k)
      groups_[k] = physx::PxGetBroadPhaseDynamicFilterGroup(static_cast<physx::PxU32>(k));
    pairs_.clear();
    slots_.clear();
  }
  void add(const physx::PxBroadPhasePair& found) {
    const Pair pair = ordered(found.mID0, found.mID1);
    slots_.put(pair, static_cast<std::uint32_t>(pairs_.size()));
    pairs_.push(pair);
  }
  void drop(const physx::PxBroadPhasePair& lost) {
    const Pair pair = ordered(lost.mID0, lost.mID1);
    const std::uint32_t slot = slots_.find(pair);
    if (slot == PairSlots::none) return;
    slots_.erase(pair);
    const Pair last = pairs_[pairs_.size() - 1];
    pairs_.resize_down(pairs_.size() - 1);
    if (slot == pairs_.size()) return;
    pairs_[slot] = last;
    slots_.put(last, slot);
  }

  physx::PxBroadPhaseType::Enum type_;
  std::unique_ptr<physx::PxBroadPhase, Release> phase_;
  std::size_t count_ = 0;
  std::vector<physx::PxBounds3> bounds_;
  std::vector<float> distances_;
  std::vector<physx::PxBpFilterGroup> groups_;
  std::vector<physx::PxBpIndex> changed_;
  PairList pairs_;
  PairSlots slots_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "physx-abp") return std::make_unique<Physx>(physx::PxBroadPhaseType::eABP);
  if (name == "physx-pabp") return std::make_unique<Physx>(physx::PxBroadPhaseType::ePABP);
  if (name == "physx-sap") return std::make_unique<Physx>(physx::PxBroadPhaseType::eSAP);
  return nullptr;
}

}  // namespace

BoxLibrary physx_boxes() { return {make, {"physx-abp", "physx-pabp", "physx-sap"}}; }

}  // namespace bvlab
