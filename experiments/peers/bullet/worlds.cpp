// SPDX-License-Identifier: BSD-3-Clause
/// Bullet's pipeline: dynamic trees of boxes with a cache of pairs in front, GImpact for concave
/// meshes behind. Bodies that did not move are asleep: their boxes are not computed again, and a
/// pair of two sleepers is not queried. Bullet works in float32 and finds all contacts, where we
/// and FCL stop at the first; it has no cheaper question for concave meshes.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <algorithm>

#include "experiments/peers/world_peers.hpp"

namespace bvlab {
namespace {

struct Model {
  std::vector<btScalar> vertices;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> array;
  std::unique_ptr<btGImpactMeshShape> shape;

  explicit Model(const TriangleMesh& mesh) {
    for (const auto& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<btScalar>(v[axis]));
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle) indices.push_back(static_cast<int>(v));
    array = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), indices.data(), 3 * sizeof(int),
        static_cast<int>(mesh.vertices.size()), vertices.data(), 3 * sizeof(btScalar));
    shape = std::make_unique<btGImpactMeshShape>(array.get());
    shape->setMargin(0);
    shape->updateBound();
  }
};

class BulletWorld final : public WorldEngine {
 public:
  BulletWorld(std::span<const TriangleMesh> meshes, std::size_t objects)
      : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &configuration_) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    world_.setForceUpdateAllAabbs(false);
    for (const auto& mesh : meshes) models_.push_back(std::make_unique<Model>(mesh));
    for (std::size_t i = 0; i < objects; ++i) {
      auto object = std::make_unique<btCollisionObject>();
      object->setCollisionShape(models_[i % models_.size()]->shape.get());
      object->setUserIndex(static_cast<int>(i));
      object->setContactProcessingThreshold(0);
      objects_.push_back(std::move(object));
    }
  }
  ~BulletWorld() override {
    for (auto& object : objects_) world_.removeCollisionObject(object.get());
  }

  void move(std::uint32_t object, const Pose& pose) override {
    btTransform transform;
    const auto& r = pose.rotation;
    const auto s = [](double x) { return static_cast<btScalar>(x); };
    transform.getBasis().setValue(s(r(0, 0)), s(r(0, 1)), s(r(0, 2)), s(r(1, 0)), s(r(1, 1)),
                                  s(r(1, 2)), s(r(2, 0)), s(r(2, 1)), s(r(2, 2)));
    transform.setOrigin(
        btVector3(s(pose.translation[0]), s(pose.translation[1]), s(pose.translation[2])));
    objects_[object]->setWorldTransform(transform);
    if (entered_) objects_[object]->forceActivationState(ACTIVE_TAG);
    moved_.push_back(object);
  }

  void update() override {
    if (!entered_)
      for (auto& object : objects_) world_.addCollisionObject(object.get());
    entered_ = true;
    world_.performDiscreteCollisionDetection();
    for (const auto i : moved_) objects_[i]->forceActivationState(ISLAND_SLEEPING);
    moved_.clear();
  }

  std::span<const ObjectPair> touching() override {
    touching_.clear();
    for (int k = 0; k < dispatcher_.getNumManifolds(); ++k) {
      const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(k);
      bool meets = false;
      for (int c = 0; c < manifold->getNumContacts(); ++c)
        meets = meets || manifold->getContactPoint(c).getDistance() <= 0;
      if (!meets) continue;
      const auto [i, j] =
          std::minmax({static_cast<std::uint32_t>(manifold->getBody0()->getUserIndex()),
                       static_cast<std::uint32_t>(manifold->getBody1()->getUserIndex())});
      touching_.push_back({i, j});
    }
    return touching_;
  }

 private:
  std::vector<std::unique_ptr<Model>> models_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  btDefaultCollisionConfiguration configuration_;
  btDbvtBroadphase broadphase_;
  btCollisionDispatcher dispatcher_;
  btCollisionWorld world_;
  std::vector<std::uint32_t> moved_;
  std::vector<ObjectPair> touching_;
  bool entered_ = false;
};

std::unique_ptr<WorldEngine> make(std::span<const TriangleMesh> meshes, std::size_t objects) {
  return std::make_unique<BulletWorld>(meshes, objects);
}

}  // namespace

std::span<const WorldPeer> bullet_worlds() {
  static constexpr WorldPeer list[] = {
      {"bullet-world", make},  // dynamic trees of boxes, GImpact
  };
  return list;
}

}  // namespace bvlab
