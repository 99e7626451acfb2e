// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/fcl.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>

#include <limits>

#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

template <class Volume>
class FclWorld {
 public:
  FclWorld(std::span<const TriangleMesh> meshes, std::size_t objects) {
    for (const auto& mesh : meshes) {
      auto model = std::make_shared<fcl::BVHModel<Volume>>();
      std::vector<fcl::Triangle> triangles;
      for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
      model->beginModel();
      model->addSubModel(mesh.vertices, triangles);
      model->endModel();
      models_.push_back(std::move(model));
    }
    poses_.resize(objects, fcl::Transform3d::Identity());
  }

  void place(std::size_t i, const Pose& pose) {
    poses_[i].linear() = pose.rotation;
    poses_[i].translation() = pose.translation;
  }

  bool touching(std::size_t i, std::size_t j) {
    fcl::CollisionResultd result;
    return collide(i, j, 1, result) > 0;
  }

  void contacts(std::size_t i, std::size_t j, std::vector<Contact>& found) {
    fcl::CollisionResultd result;
    collide(i, j, std::numeric_limits<std::size_t>::max(), result);
    for (std::size_t k = 0; k < result.numContacts(); ++k) {
      const auto& contact = result.getContact(k);
      found.push_back(
          {static_cast<std::uint32_t>(contact.b1), static_cast<std::uint32_t>(contact.b2)});
    }
  }

 private:
  std::size_t collide(std::size_t i, std::size_t j, std::size_t most,
                      fcl::CollisionResultd& result) {
    const fcl::CollisionRequestd request(most, false);
    return fcl::collide(models_[i % models_.size()].get(), poses_[i],
                        models_[j % models_.size()].get(), poses_[j], request, result);
  }

  std::vector<std::shared_ptr<fcl::BVHModel<Volume>>> models_;
  std::vector<fcl::Transform3d> poses_;
};

}  // namespace

ReplayResult replay_fcl_obb(std::span<const TriangleMesh> meshes, const Trace& trace,
                            std::string_view query, const ReplayOptions& options) {
  return play_peer<FclWorld<fcl::OBBd>>(meshes, trace, query, options);
}

ReplayResult replay_fcl_obbrss(std::span<const TriangleMesh> meshes, const Trace& trace,
                               std::string_view query, const ReplayOptions& options) {
  return play_peer<FclWorld<fcl::OBBRSSd>>(meshes, trace, query, options);
}

}  // namespace bvlab
