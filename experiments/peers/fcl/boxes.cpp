// SPDX-License-Identifier: BSD-3-Clause
/// FCL's broad-phase managers: the dynamic tree, and the three that sort. SaP and IntervalTree miss
/// touching pairs, so they are here to be shown missing them.
#include <fcl/broadphase/broadphase_SSaP.h>
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/broadphase_interval_tree.h>
#include <fcl/geometry/shape/sphere.h>

#include "broadphase/structures/pair_list.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

template <class Manager>
class Fcl final : public BoxPeer {
 public:
  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    const bool fresh = boxes.size() != objects_.size();
    if (fresh) {
      manager_ = std::make_unique<Manager>();
      objects_.clear();
      for (std::size_t k = 0; k < boxes.size(); ++k)
        objects_.push_back(std::make_unique<fcl::CollisionObject<float>>(shape_));
    }
    for (std::uint32_t k = 0; k < boxes.size(); ++k) {
      // The object's box is set directly: the manager reads nothing else of it.
      auto& aabb = const_cast<fcl::AABB<float>&>(objects_[k]->getAABB());
      for (int axis = 0; axis < 3; ++axis)
        aabb.min_[axis] = boxes[k].lo[axis], aabb.max_[axis] = boxes[k].hi[axis];
      objects_[k]->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(k)));
      if (fresh) pointers_.resize(boxes.size()), pointers_[k] = objects_[k].get();
    }
    if (fresh)
      manager_->registerObjects(pointers_), manager_->setup();
    else
      manager_->update();
    pairs_.clear();
    manager_->collide(
        this, [](fcl::CollisionObject<float>* a, fcl::CollisionObject<float>* b, void* self) {
          if (a->getAABB().overlap(b->getAABB()))
            static_cast<Fcl*>(self)->pairs_.push(ordered(index(a), index(b)));
          return false;
        });
    return pairs_.view();
  }

 private:
  static std::uint32_t index(fcl::CollisionObject<float>* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
  }
  std::shared_ptr<fcl::CollisionGeometry<float>> shape_ =
      std::make_shared<fcl::Sphere<float>>(1.0f);
  std::unique_ptr<Manager> manager_;
  std::vector<std::unique_ptr<fcl::CollisionObject<float>>> objects_;
  std::vector<fcl::CollisionObject<float>*> pointers_;
  PairList pairs_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "fcl-tree")
    return std::make_unique<Fcl<fcl::DynamicAABBTreeCollisionManager<float>>>();
  if (name == "fcl-ssap") return std::make_unique<Fcl<fcl::SSaPCollisionManager<float>>>();
  if (name == "fcl-sap") return std::make_unique<Fcl<fcl::SaPCollisionManager<float>>>();
  if (name == "fcl-interval")
    return std::make_unique<Fcl<fcl::IntervalTreeCollisionManager<float>>>();
  return nullptr;
}

}  // namespace

BoxLibrary fcl_boxes() { return {make, {"fcl-tree", "fcl-ssap", "fcl-sap", "fcl-interval"}}; }

}  // namespace bvlab
