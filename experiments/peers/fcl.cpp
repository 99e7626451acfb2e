// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/fcl.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/traversal/collision/mesh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>
#include <fcl/narrowphase/distance.h>

#include <limits>

#include "experiments/peers/play_peer.hpp"
#include "traversal/counters.hpp"

namespace bvlab {
namespace {

/// FCL's traversal of two such models that are not copied; nothing for the others.
template <class Volume>
struct Oriented {
  static constexpr bool exists = false;
};
template <>
struct Oriented<fcl::OBBd> {
  static constexpr bool exists = true;
  using Node = fcl::detail::MeshCollisionTraversalNodeOBB<double>;
};
template <>
struct Oriented<fcl::OBBRSSd> {
  static constexpr bool exists = true;
  using Node = fcl::detail::MeshCollisionTraversalNodeOBBRSS<double>;
};
template <>
struct Oriented<fcl::kIOSd> {
  static constexpr bool exists = true;
  using Node = fcl::detail::MeshCollisionTraversalNodekIOS<double>;
};

template <class Volume, class Counter>
class FclWorld {
 public:
  FclWorld(std::span<const TriangleMesh> meshes, std::size_t objects) {
    for (const auto& mesh : meshes) {
      auto model = std::make_shared<Model>();
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

  double distance(std::size_t i, std::size_t j) {
    const fcl::DistanceRequestd request(false, false, 0, 0);
    fcl::DistanceResultd result;
    fcl::distance(&model(i), poses_[i], &model(j), poses_[j], request, result);
    // Below zero says that they touch.
    return std::max(0.0, result.min_distance);
  }

  const Counter& counter() const { return counter_; }

 private:
  using Model = fcl::BVHModel<Volume>;

  const Model& model(std::size_t i) const { return *models_[i % models_.size()]; }

  std::size_t collide(std::size_t i, std::size_t j, std::size_t most,
                      fcl::CollisionResultd& result) {
    const fcl::CollisionRequestd request(most, false);
    if constexpr (Counter::counts && Oriented<Volume>::exists) {
      // What fcl::collide does, with the statistics switched on.
      typename Oriented<Volume>::Node node;
      fcl::detail::initialize(node, model(i), poses_[i], model(j), poses_[j], request, result);
      node.enable_statistics = true;
      fcl::detail::collide(static_cast<fcl::detail::CollisionTraversalNodeBase<double>*>(&node));
      counter_.tested(static_cast<std::uint64_t>(node.num_bv_tests));
      counter_.primitives(static_cast<std::uint64_t>(node.num_leaf_tests));
      return result.numContacts();
    } else {
      return fcl::collide(&model(i), poses_[i], &model(j), poses_[j], request, result);
    }
  }

  std::vector<std::shared_ptr<Model>> models_;
  std::vector<fcl::Transform3d> poses_;
  Counter counter_;
};

template <FclModel>
struct VolumeOf;
template <>
struct VolumeOf<FclModel::obb> : std::type_identity<fcl::OBBd> {};
template <>
struct VolumeOf<FclModel::obbrss> : std::type_identity<fcl::OBBRSSd> {};
template <>
struct VolumeOf<FclModel::kios> : std::type_identity<fcl::kIOSd> {};
template <>
struct VolumeOf<FclModel::rss> : std::type_identity<fcl::RSSd> {};
template <>
struct VolumeOf<FclModel::aabb> : std::type_identity<fcl::AABBd> {};
template <>
struct VolumeOf<FclModel::kdop16> : std::type_identity<fcl::KDOP<double, 16>> {};
template <>
struct VolumeOf<FclModel::kdop18> : std::type_identity<fcl::KDOP<double, 18>> {};
template <>
struct VolumeOf<FclModel::kdop24> : std::type_identity<fcl::KDOP<double, 24>> {};

}  // namespace

template <FclModel model>
ReplayResult replay_fcl(std::span<const TriangleMesh> meshes, const Trace& trace,
                        std::string_view query, const ReplayOptions& options) {
  using Volume = typename VolumeOf<model>::type;
  return options.count == Count::on
             ? play_peer<FclWorld<Volume, Counting>>(meshes, trace, query, options)
             : play_peer<FclWorld<Volume, NotCounting>>(meshes, trace, query, options);
}

#define BVLAB_FCL_PEER(model)                                                                    \
  template ReplayResult replay_fcl<FclModel::model>(std::span<const TriangleMesh>, const Trace&, \
                                                    std::string_view, const ReplayOptions&)
BVLAB_FCL_PEER(obb);
BVLAB_FCL_PEER(obbrss);
BVLAB_FCL_PEER(kios);
BVLAB_FCL_PEER(rss);
BVLAB_FCL_PEER(aabb);
BVLAB_FCL_PEER(kdop16);
BVLAB_FCL_PEER(kdop18);
BVLAB_FCL_PEER(kdop24);

}  // namespace bvlab
