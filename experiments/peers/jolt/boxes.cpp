// SPDX-License-Identifier: BSD-3-Clause
/// Jolt's broad phase, used in the order of its own step: the bounds of bodies that moved are
/// reported, the tree is rebuilt where it was widened, and the bodies that moved ask for their
/// pairs. It answers for those bodies only, so the list of all pairs is kept here, as part of its
/// time.
#include <Jolt/Jolt.h>
// The line above comes first in every source that uses Jolt.
#include <Jolt/Core/Factory.h>
#include <Jolt/Physics/Body/Body.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Body/BodyManager.h>
#include <Jolt/Physics/Body/BodyPair.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhaseQuadTree.h>
#include <Jolt/Physics/Collision/CollisionCollectorImpl.h>
#include <Jolt/Physics/Collision/Shape/Shape.h>
#include <Jolt/Physics/Collision/TransformedShape.h>

#include <cstring>
#include <memory>

#include "broadphase/structures/pair_list.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

/// A shape that has nothing but its bounds in the world, exactly as they are given. A box shape
/// would round them: it has a half extent and a centre.
class Bounds final : public JPH::Shape {
 public:
  Bounds() : Shape(JPH::EShapeType::User1, JPH::EShapeSubType::User1) { SetEmbedded(); }
  void set(const Box<float>& box) {
    bounds_ = JPH::AABox(JPH::Vec3(box.lo[0], box.lo[1], box.lo[2]),
                         JPH::Vec3(box.hi[0], box.hi[1], box.hi[2]));
  }

  JPH::AABox GetLocalBounds() const override { return bounds_; }
  JPH::AABox GetWorldSpaceBounds(JPH::Mat44Arg, JPH::Vec3Arg) const override { return bounds_; }
  JPH::MassProperties GetMassProperties() const override { return {1, JPH::Mat44::sIdentity()}; }

  JPH::uint GetSubShapeIDBitsRecursive() const override { return 0; }
  float GetInnerRadius() const override { return 0; }
  const JPH::PhysicsMaterial* GetMaterial(const JPH::SubShapeID&) const override { return nullptr; }
  JPH::Vec3 GetSurfaceNormal(const JPH::SubShapeID&, JPH::Vec3Arg) const override {
    return JPH::Vec3::sZero();
  }
  void GetSubmergedVolume(JPH::Mat44Arg, JPH::Vec3Arg, const JPH::Plane&, float&, float&,
                          JPH::Vec3&) const override {}
  bool CastRay(const JPH::RayCast&, const JPH::SubShapeIDCreator&,
               JPH::RayCastResult&) const override {
    return false;
  }
  void CastRay(const JPH::RayCast&, const JPH::RayCastSettings&, const JPH::SubShapeIDCreator&,
               JPH::CastRayCollector&, const JPH::ShapeFilter&) const override {}
  void CollidePoint(JPH::Vec3Arg, const JPH::SubShapeIDCreator&, JPH::CollidePointCollector&,
                    const JPH::ShapeFilter&) const override {}
  void CollideSoftBodyVertices(JPH::Mat44Arg, JPH::Vec3Arg,
                               const JPH::CollideSoftBodyVertexIterator&, JPH::uint,
                               int) const override {}
  void GetTrianglesStart(GetTrianglesContext&, const JPH::AABox&, JPH::Vec3Arg, JPH::QuatArg,
                         JPH::Vec3Arg) const override {}
  int GetTrianglesNext(GetTrianglesContext&, int, JPH::Float3*,
                       const JPH::PhysicsMaterial**) const override {
    return 0;
  }
  Stats GetStats() const override { return {sizeof *this, 0}; }
  float GetVolume() const override { return 1; }

 private:
  JPH::AABox bounds_;
};

class OneLayer final : public JPH::BroadPhaseLayerInterface {
 public:
  JPH::uint GetNumBroadPhaseLayers() const override { return 1; }
  JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer) const override {
    return JPH::BroadPhaseLayer(0);
  }
};

/// Pairs, with those of each box in a linked list, so that a box's pairs go at once.
class PairsOfBoxes {
 public:
  void clear(std::size_t boxes) {
    pairs_.clear();
    links_.clear();
    first_.assign(boxes, none);
    linked_ = true;
  }
  /// Links are made when a box's pairs are first to go.
  void clear_unlinked() {
    pairs_.clear();
    linked_ = false;
  }
  void add(Pair pair) {
    pairs_.push(pair);
    if (linked_) link(static_cast<std::uint32_t>(pairs_.size() - 1));
  }
  void remove_of(std::uint32_t box) {
    if (!linked_) link_all();
    while (first_[box] != none) remove(first_[box] / 2);
  }
  std::span<const Pair> view() const { return pairs_.view(); }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  /// The end 2k is pair k's in the list of its first box, 2k + 1 that in the list of its second.
  struct Link {
    std::uint32_t next, previous;
  };

  std::uint32_t box_of(std::uint32_t end) const {
    return end % 2 == 0 ? pairs_[end / 2].i : pairs_[end / 2].j;
  }
  void link(std::uint32_t pair) {
    for (std::uint32_t end = 2 * pair; end < 2 * pair + 2; ++end) {
      std::uint32_t& first = first_[box_of(end)];
      links_.push_back({first, none});
      if (first != none) links_[first].previous = end;
      first = end;
    }
  }
  void link_all() {
    links_.clear();
    std::fill(first_.begin(), first_.end(), none);
    for (std::uint32_t k = 0; k < pairs_.size(); ++k) link(k);
    linked_ = true;
  }
  void unlink(std::uint32_t end) {
    const auto [next, previous] = links_[end];
    if (next != none) links_[next].previous = previous;
    (previous != none ? links_[previous].next : first_[box_of(end)]) = next;
  }
  void remove(std::uint32_t pair) {
    unlink(2 * pair), unlink(2 * pair + 1);
    const auto last = static_cast<std::uint32_t>(pairs_.size() - 1);
    if (pair != last) {
      for (std::uint32_t side = 0; side < 2; ++side) {
        const std::uint32_t from = 2 * last + side, to = 2 * pair + side;
        const Link moved = links_[to] = links_[from];
        if (moved.next != none) links_[moved.next].previous = to;
        (moved.previous != none ? links_[moved.previous].next : first_[box_of(from)]) = to;
      }
      pairs_[pair] = pairs_[last];
    }
    pairs_.resize_down(last);
    links_.resize(2 * std::size_t{last});
  }

  PairList pairs_;
  std::vector<Link> links_;
  std::vector<std::uint32_t> first_;  ///< of each box
  bool linked_ = true;
};

class Jolt final : public BoxPeer {
 public:
  Jolt() { [[maybe_unused]] static const bool once = (JPH::RegisterDefaultAllocator(), true); }

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    if (boxes.size() != last_.size()) return enter(boxes);
    moved_.clear();
    for (std::uint32_t k = 0; k < boxes.size(); ++k)
      if (std::memcmp(&boxes[k], &last_[k], sizeof boxes[k]) != 0) {
        last_[k] = boxes[k];
        moved_.push_back(k);
      }
    return move(boxes, moved_);
  }
  std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t> moved) override {
    return boxes.size() != last_.size() ? enter(boxes) : move(boxes, moved);
  }
  bool takes_moved() const override { return true; }

 private:
  /// What one set of boxes needs. The bodies go before their shapes.
  struct Scene {
    OneLayer layers;
    std::vector<Bounds> shapes;
    JPH::BodyManager bodies;
    JPH::BroadPhaseQuadTree tree;

    explicit Scene(Boxes<float> boxes) : shapes(boxes.size()) {
      const auto count = static_cast<JPH::uint>(boxes.size());
      bodies.Init(count, 0, layers);
      tree.Init(&bodies, layers);
      for (JPH::uint k = 0; k < count; ++k) {
        shapes[k].set(boxes[k]);
        const JPH::BodyCreationSettings settings(
            &shapes[k], JPH::RVec3::sZero(), JPH::Quat::sIdentity(), JPH::EMotionType::Dynamic, 0);
        bodies.AddBody(bodies.AllocateBody(settings));
      }
    }
    JPH::BodyID id(std::uint32_t k) const { return bodies.GetBodies()[k]->GetID(); }
  };

  std::span<const Pair> enter(Boxes<float> boxes) {
    last_.assign(boxes.begin(), boxes.end());
    active_.clear();
    pairs_.clear(boxes.size());
    scene_ = std::make_unique<Scene>(boxes);
    if (boxes.empty()) return pairs_.view();
    for (std::uint32_t k = 0; k < boxes.size(); ++k) active_.push_back(scene_->id(k));
    const auto count = static_cast<int>(active_.size());
    const auto state = scene_->tree.AddBodiesPrepare(active_.data(), count);
    scene_->tree.AddBodiesFinalize(active_.data(), count, state);
    scene_->tree.Optimize();
    scene_->bodies.ActivateBodies(active_.data(), count);
    pairs_.clear_unlinked();
    find();
    return pairs_.view();
  }

  std::span<const Pair> move(Boxes<float> boxes, std::span<const std::uint32_t> moved) {
    if (moved.empty()) return pairs_.view();
    // Which of two bodies reports their pair depends on which are active: those that moved.
    const bool all = moved.size() == boxes.size();
    if (!all || active_.size() != boxes.size()) {
      scene_->bodies.DeactivateBodies(active_.data(), static_cast<int>(active_.size()));
      active_.clear();
      for (const std::uint32_t k : moved) active_.push_back(scene_->id(k));
      scene_->bodies.ActivateBodies(active_.data(), static_cast<int>(active_.size()));
    }
    for (const std::uint32_t k : moved) {
      scene_->shapes[k].set(boxes[k]);
      scene_->bodies.GetBodies()[k]->CalculateWorldSpaceBoundsInternal();
    }
    scene_->tree.NotifyBodiesAABBChanged(active_.data(), static_cast<int>(active_.size()), true);
    scene_->tree.FrameSync();
    scene_->tree.LockModifications();
    scene_->tree.UpdateFinalize(scene_->tree.UpdatePrepare());
    scene_->tree.UnlockModifications();
    if (all)
      pairs_.clear_unlinked();
    else
      for (const std::uint32_t k : moved) pairs_.remove_of(k);
    find();
    return pairs_.view();
  }

  /// Adds the pairs of active bodies.
  void find() {
    struct Collector final : JPH::BodyPairCollector {
      explicit Collector(PairsOfBoxes& pairs) : pairs(pairs) {}
      void AddHit(const JPH::BodyPair& pair) override {
        pairs.add(ordered(pair.mBodyA.GetIndex(), pair.mBodyB.GetIndex()));
      }
      PairsOfBoxes& pairs;
    } collector(pairs_);
    scene_->tree.FindCollidingPairs(active_.data(), static_cast<int>(active_.size()), 0,
                                    JPH::ObjectVsBroadPhaseLayerFilter(),
                                    JPH::ObjectLayerPairFilter(), collector);
  }

  std::vector<Box<float>> last_;
  std::vector<std::uint32_t> moved_;
  std::vector<JPH::BodyID> active_;
  PairsOfBoxes pairs_;
  std::unique_ptr<Scene> scene_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "jolt") return std::make_unique<Jolt>();
  return nullptr;
}

}  // namespace

BoxLibrary jolt_boxes() { return {make, {"jolt"}}; }

}  // namespace bvlab
