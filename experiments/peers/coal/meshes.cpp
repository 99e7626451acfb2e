// SPDX-License-Identifier: BSD-3-Clause
/// Coal (once HPP-FCL), mesh against mesh, by its bounding volume. One contact and no details of it
/// where a yes or no is asked; functions looked up once; boxes are opened where they meet and not
/// also where they are less than 1e-3 apart, which is its default. Triangles less than 1e-12 apart
/// are touching to it. Nothing is counted.
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>

#include <limits>

#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

template <class Volume>
class CoalWorld {
 public:
  CoalWorld(std::span<const TriangleMesh> meshes, std::size_t objects) : poses_(objects) {
    for (const auto& mesh : meshes) {
      auto model = std::make_shared<Model>();
      std::vector<coal::Triangle> triangles;
      for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
      model->beginModel(static_cast<unsigned>(triangles.size()),
                        static_cast<unsigned>(mesh.vertices.size()));
      model->addSubModel(mesh.vertices, triangles);
      model->endModel();
      models_.push_back(std::move(model));
    }
    // For every pair of models.
    for (const auto& a : models_)
      for (const auto& b : models_) {
        collide_.push_back(std::make_unique<coal::ComputeCollision>(a.get(), b.get()));
        distance_.push_back(std::make_unique<coal::ComputeDistance>(a.get(), b.get()));
      }
    one_.break_distance = all_.break_distance = 0;
  }

  void place(std::size_t i, const Pose& pose) {
    poses_[i].setTransform(pose.rotation, pose.translation);
  }

  bool touching(std::size_t i, std::size_t j) {
    collided_.clear();
    return (*collide_[both(i, j)])(poses_[i], poses_[j], one_, collided_) > 0;
  }

  void contacts(std::size_t i, std::size_t j, std::vector<Contact>& found) {
    collided_.clear();
    (*collide_[both(i, j)])(poses_[i], poses_[j], all_, collided_);
    for (const auto& contact : collided_.getContacts())
      found.push_back(
          {static_cast<std::uint32_t>(contact.b1), static_cast<std::uint32_t>(contact.b2)});
  }

  double distance(std::size_t i, std::size_t j) {
    result_.clear();
    (*distance_[both(i, j)])(poses_[i], poses_[j], asked_, result_);
    // Below zero says that they touch.
    return std::max(0.0, result_.min_distance);
  }

 private:
  using Model = coal::BVHModel<Volume>;

  std::size_t both(std::size_t i, std::size_t j) const {
    return i % models_.size() * models_.size() + j % models_.size();
  }

  std::vector<std::shared_ptr<Model>> models_;
  std::vector<coal::Transform3s> poses_;
  std::vector<std::unique_ptr<coal::ComputeCollision>> collide_;
  std::vector<std::unique_ptr<coal::ComputeDistance>> distance_;
  coal::CollisionRequest one_{coal::NO_REQUEST, 1},
      all_{coal::NO_REQUEST, std::numeric_limits<std::size_t>::max()};
  coal::DistanceRequest asked_{false, false};
  coal::CollisionResult collided_;
  coal::DistanceResult result_;
};

}  // namespace

std::span<const Peer> coal_peers() {
  static constexpr Peer list[] = {
      {"coal-obb", "Coal 3.0: oriented boxes; touching is less than 1e-12 apart",
       "touching contacts", play_peer<CoalWorld<coal::OBB>>},
      {"coal-obbrss", "Coal 3.0: oriented boxes and rectangle swept spheres; touching likewise",
       "touching contacts distance", play_peer<CoalWorld<coal::OBBRSS>>},
      {"coal-rss", "Coal 3.0: rectangle swept spheres", "distance",
       play_peer<CoalWorld<coal::RSS>>},
  };
  return list;
}

}  // namespace bvlab
