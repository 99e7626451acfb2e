// SPDX-License-Identifier: BSD-3-Clause
/// Bullet's GImpact meshes: float32, boxes quantised to 16 bits. It has no way to stop at the first
/// contact.
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <deque>

#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

/// Whatever is reported is a contact: margins are 0.
class AnyContact final : public btManifoldResult {
 public:
  using btManifoldResult::btManifoldResult;
  void addContactPoint(const btVector3&, const btVector3&, btScalar) override { found = true; }
  bool found = false;
};

class BulletWorld {
 public:
  BulletWorld(std::span<const TriangleMesh> meshes, std::size_t objects) {
    for (const auto& mesh : meshes) {
      triangles_.push_back(std::make_unique<btTriangleMesh>());
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle corners = mesh.corners(t);
        triangles_.back()->addTriangle(vector(corners[0]), vector(corners[1]), vector(corners[2]));
      }
      shapes_.push_back(std::make_unique<btGImpactMeshShape>(triangles_.back().get()));
      shapes_.back()->setMargin(0);
      shapes_.back()->updateBound();
    }
    for (std::size_t i = 0; i < objects; ++i)
      bodies_.emplace_back().setCollisionShape(shapes_[i % shapes_.size()].get());
  }

  void place(std::size_t i, const Pose& pose) {
    const auto& r = pose.rotation;
    const auto f = [](double x) { return static_cast<btScalar>(x); };
    bodies_[i].setWorldTransform(
        btTransform(btMatrix3x3(f(r(0, 0)), f(r(0, 1)), f(r(0, 2)), f(r(1, 0)), f(r(1, 1)),
                                f(r(1, 2)), f(r(2, 0)), f(r(2, 1)), f(r(2, 2))),
                    vector(pose.translation)));
  }

  bool touching(std::size_t i, std::size_t j) {
    const btCollisionObjectWrapper a = wrapped(bodies_[i]), b = wrapped(bodies_[j]);
    btCollisionAlgorithmConstructionInfo info(&dispatcher_, 0);
    btGImpactCollisionAlgorithm algorithm(info, &a, &b);
    AnyContact result(&a, &b);
    algorithm.processCollision(&a, &b, {}, &result);
    return result.found;
  }

 private:
  static btVector3 vector(const Vec3<double>& v) {
    return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
  }

  static btCollisionObjectWrapper wrapped(const btCollisionObject& body) {
    return {nullptr, body.getCollisionShape(), &body, body.getWorldTransform(), -1, -1};
  }

  std::vector<std::unique_ptr<btTriangleMesh>> triangles_;
  std::vector<std::unique_ptr<btGImpactMeshShape>> shapes_;
  std::deque<btCollisionObject> bodies_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
};

}  // namespace

std::span<const Peer> bullet_peers() {
  static constexpr Peer list[] = {
      {"bullet", "Bullet 3.24: GImpact, float32, margins 0; looks for all contacts", "touching",
       play_peer<BulletWorld>},
  };
  return list;
}

}  // namespace bvlab
