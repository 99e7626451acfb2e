// SPDX-License-Identifier: BSD-3-Clause
/// FCL 0.7's mesh against mesh, by its bounding volume. Volume tests and triangle tests of obb,
/// obbrss and kios are FCL's own count, where counts are wanted; otherwise its public functions
/// are called and nothing is counted.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/traversal/collision/mesh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>
#include <fcl/narrowphase/distance.h>

#include <limits>

#include "experiments/peers/fcl/convex.hpp"
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

template <class Volume>
ReplayResult replay(std::span<const TriangleMesh> meshes, const Trace& trace,
                    std::string_view query, const ReplayOptions& options) {
  return play_counting_peer<FclWorld<Volume, Counting>, FclWorld<Volume, NotCounting>>(
      meshes, trace, query, options);
}

}  // namespace

std::span<const Peer> fcl_peers() {
  static constexpr Peer list[] = {
      {"fcl-obb", "FCL 0.7: oriented boxes, recursive", "touching contacts", replay<fcl::OBBd>},
      {"fcl-obbrss",
       "FCL 0.7: oriented boxes and rectangle swept spheres, recursive; distances without error",
       "touching contacts distance", replay<fcl::OBBRSSd>},
      {"fcl-kios",
       "FCL 0.7: spheres intersected with oriented boxes, recursive; distances without error",
       "touching contacts distance", replay<fcl::kIOSd>},
      {"fcl-rss",
       "FCL 0.7: rectangle swept spheres, recursive; distances without error; copies both meshes "
       "at every query other than distance",
       "touching contacts distance", replay<fcl::RSSd>},
      {"fcl-aabb", "FCL 0.7: axis-aligned boxes; copies both meshes at every query",
       "touching contacts", replay<fcl::AABBd>},
      {"fcl-kdop16", "FCL 0.7: 16-DOPs; copies both meshes at every query", "touching contacts",
       replay<fcl::KDOP<double, 16>>},
      {"fcl-kdop18", "FCL 0.7: 18-DOPs; copies both meshes at every query", "touching contacts",
       replay<fcl::KDOP<double, 18>>},
      {"fcl-kdop24", "FCL 0.7: 24-DOPs; copies both meshes at every query", "touching contacts",
       replay<fcl::KDOP<double, 24>>},
      {"fcl-gjk", "FCL 0.7: its own GJK, from the last direction, to 1e-10; convex solids only",
       "distance", replay_fcl_gjk, true},
      {"libccd-gjk", "FCL 0.7 on libccd 2.1: GJK from scratch, to 1e-10; convex solids only",
       "distance", replay_libccd_gjk, true},
  };
  return list;
}

}  // namespace bvlab
