// SPDX-License-Identifier: BSD-3-Clause
/// FCL's pipeline: its dynamic tree of boxes in front, updated for the bodies that moved, and its
/// trees of oriented boxes behind. It keeps no answers, so every pair is asked in every frame.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>

#include "experiments/peers/world_peers.hpp"

namespace bvlab {
namespace {

using Object = fcl::CollisionObjectd;

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
  }

  void move(std::uint32_t object, const Pose& pose) override {
    objects_[object]->setTransform(pose.rotation, pose.translation);
    objects_[object]->computeAABB();
    moved_.push_back(objects_[object].get());
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
    touching_.clear();
    manager_.collide(this, [](Object* a, Object* b, void* self) {
      static_cast<FclWorld*>(self)->ask(a, b);
      return false;
    });
  }

  std::span<const ObjectPair> touching() override { return touching_; }

 private:
  void ask(Object* a, Object* b) {
    const fcl::CollisionRequestd request(1, false);
    fcl::CollisionResultd result;
    if (fcl::collide(a, b, request, result) == 0) return;
    const auto [i, j] = std::minmax({index(a), index(b)});
    touching_.push_back({i, j});
  }
  static std::uint32_t index(const Object* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
  }

  std::vector<std::unique_ptr<Object>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
  std::vector<Object*> moved_;
  std::vector<ObjectPair> touching_;
  bool registered_ = false;
};

}  // namespace

std::unique_ptr<WorldEngine> make_fcl_world(std::span<const TriangleMesh> meshes,
                                            std::size_t objects) {
  return std::make_unique<FclWorld>(meshes, objects);
}

}  // namespace bvlab
