// SPDX-License-Identifier: BSD-3-Clause
/// FCL's pipeline: its dynamic tree of boxes in front, updated for the bodies that moved, and its
/// trees of oriented boxes behind. It keeps no answers, so every pair is queried in every frame; or
/// its user keeps them, as its callback allows: then only pairs with a moved body are queried.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>

#include <unordered_set>

#include "experiments/peers/world_peers.hpp"

namespace bvlab {
namespace {

using Object = fcl::CollisionObjectd;

/// Which near pairs FCL is queried for in a frame: all, or those with a body that moved.
enum class FclPairs { all, moved };

template <FclPairs which>
class FclWorld final : public WorldEngine {
 public:
  FclWorld(std::span<const TriangleMesh> meshes, std::size_t objects) {
    std::vector<std::shared_ptr<fcl::BVHModel<fcl::OBBd>>> models;
    for (const auto& mesh : meshes) {
      auto model = std::make_shared<fcl::BVHModel<fcl::OBBd>>();
      std::vector<fcl::Triangle> triangles;
      for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
      model->beginModel();
      model->addSubModel(mesh.vertices, triangles);
      model->endModel();
      models.push_back(std::move(model));
    }
    for (std::size_t i = 0; i < objects; ++i) {
      objects_.push_back(std::make_unique<Object>(models[i % models.size()]));
      objects_[i]->setUserData(reinterpret_cast<void*>(i));
    }
    has_moved_.resize(objects, true);
  }

  void move(std::uint32_t object, const Pose& pose) override {
    objects_[object]->setTransform(pose.rotation, pose.translation);
    objects_[object]->computeAABB();
    moved_.push_back(objects_[object].get());
    has_moved_[object] = true;
  }

  void update() override {
    if (registered_) {
      manager_.update(moved_);
    } else {
      std::vector<Object*> all;
      for (const auto& each : objects_) all.push_back(each.get());
      manager_.registerObjects(all);
      manager_.setup();
      registered_ = true;
    }
    moved_.clear();
    if constexpr (which == FclPairs::moved) {
      touched_.clear();
      for (const auto& pair : touching_) touched_.insert(key(pair));
    }
    touching_.clear();
    manager_.collide(this, [](Object* a, Object* b, void* self) {
      static_cast<FclWorld*>(self)->ask(a, b);
      return false;
    });
    has_moved_.assign(has_moved_.size(), false);
  }

  std::span<const ObjectPair> touching() override { return touching_; }

 private:
  static std::uint64_t key(const ObjectPair& pair) { return std::uint64_t{pair.i} << 32 | pair.j; }

  void ask(Object* a, Object* b) {
    const auto [i, j] = std::minmax({index(a), index(b)});
    if constexpr (which == FclPairs::moved)
      if (!has_moved_[i] && !has_moved_[j]) {
        if (touched_.contains(key({i, j}))) touching_.push_back({i, j});
        return;
      }
    const fcl::CollisionRequestd request(1, false);
    fcl::CollisionResultd result;
    if (fcl::collide(a, b, request, result) == 0) return;
    touching_.push_back({i, j});
  }
  static std::uint32_t index(const Object* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
  }

  std::vector<std::unique_ptr<Object>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
  std::vector<Object*> moved_;
  std::vector<ObjectPair> touching_;
  std::vector<bool> has_moved_;
  std::unordered_set<std::uint64_t> touched_;  ///< in the last frame
  bool registered_ = false;
};

template <FclPairs which>
std::unique_ptr<WorldEngine> make(std::span<const TriangleMesh> meshes, std::size_t objects) {
  return std::make_unique<FclWorld<which>>(meshes, objects);
}

}  // namespace

std::span<const WorldPeer> fcl_worlds() {
  static constexpr WorldPeer list[] = {
      {"fcl-world", make<FclPairs::all>},          // dynamic tree of boxes, OBB trees
      {"fcl-world-moved", make<FclPairs::moved>},  // of pairs at rest the last answer
  };
  return list;
}

}  // namespace bvlab
