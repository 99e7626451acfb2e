// SPDX-License-Identifier: BSD-3-Clause
/// PhysX's mesh against mesh (PxMeshQuery::findOverlapTriangleMesh) on its BV4 trees: four-wide,
/// float32, boxes in the meshes' own frames. What was found fastest is set: trees that are not
/// quantised, built by surface area, four triangles per leaf; denormals taken for zero, set once
/// and not at every call; and, of its four triangle tests, that by separating axes, since the
/// default (Moller's, with an absolute epsilon) reports contacts that are none. Poses are taken
/// relative to the first body of the first frame, as float32 needs it.
#include <common/PxInsertionCallback.h>
#include <cooking/PxCooking.h>
#include <geometry/PxMeshQuery.h>
#include <geometry/PxReportCallback.h>
#include <geometry/PxTriangleMesh.h>
#include <geometry/PxTriangleMeshGeometry.h>
#include <xmmintrin.h>

#include <Eigen/Geometry>

#include "experiments/peers/physx/foundation.hpp"
#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

/// Denormals are zero while this lives.
class WithoutDenormals {
 public:
  WithoutDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
  WithoutDenormals(const WithoutDenormals&) = delete;
  WithoutDenormals& operator=(const WithoutDenormals&) = delete;
  ~WithoutDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
};

physx::PxVec3 vector(const Vec3<double>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

physx::PxTriangleMesh* cooked(const TriangleMesh& mesh) {
  physx_foundation();
  physx::PxCookingParams params{physx::PxTolerancesScale()};
  params.midphaseDesc.setToDefault(physx::PxMeshMidPhase::eBVH34);
  params.midphaseDesc.mBVH34Desc.quantized = false;
  params.midphaseDesc.mBVH34Desc.numPrimsPerLeaf = 4;
  params.midphaseDesc.mBVH34Desc.buildStrategy = physx::PxBVH34BuildStrategy::eSAH;
  // Triangles stay as many as they are, without area or not.
  using Preprocessing = physx::PxMeshPreprocessingFlag;
  params.meshPreprocessParams = physx::PxMeshPreprocessingFlags(physx::PxU32{
      Preprocessing::eDISABLE_CLEAN_MESH | Preprocessing::eDISABLE_ACTIVE_EDGES_PRECOMPUTE});
  std::vector<physx::PxVec3> points;
  for (const auto& v : mesh.vertices) points.push_back(vector(v));
  physx::PxTriangleMeshDesc description;
  description.points.count = static_cast<physx::PxU32>(points.size());
  description.points.stride = sizeof points[0];
  description.points.data = points.data();
  description.triangles.count = static_cast<physx::PxU32>(mesh.triangles.size());
  description.triangles.stride = sizeof mesh.triangles[0];
  description.triangles.data = mesh.triangles.data();
  physx::PxTriangleMesh* const made =
      PxCreateTriangleMesh(params, description, *PxGetStandaloneInsertionCallback());
  if (!made) throw std::runtime_error("PhysX: does not accept a mesh");
  return made;
}

using Found = physx::PxGeomIndexClosePair;

class AnyPair final : public physx::PxLocalStorageReportCallback<Found, 1> {
  bool processResults(physx::PxU32, const Found*) override { return false; }
};

class AllPairs final : public physx::PxLocalStorageReportCallback<Found, 1024> {
 public:
  AllPairs(const physx::PxU32* a, const physx::PxU32* b, std::vector<Contact>& found)
      : a_(a), b_(b), found_(found) {}

 private:
  /// Its own numbers of triangles as ours.
  bool processResults(physx::PxU32 count, const Found* pairs) override {
    for (physx::PxU32 k = 0; k < count; ++k) found_.push_back({a_[pairs[k].id0], b_[pairs[k].id1]});
    return true;
  }

  const physx::PxU32 *a_, *b_;
  std::vector<Contact>& found_;
};

class PhysxWorld {
 public:
  PhysxWorld(std::span<const TriangleMesh> meshes, std::size_t objects) : poses_(objects) {
    for (const auto& mesh : meshes) {
      meshes_.emplace_back(cooked(mesh));
      shapes_.emplace_back(meshes_.back().get());
    }
  }

  void place(std::size_t i, const Pose& pose) {
    if (!placed_) origin_ = pose.translation, placed_ = true;
    const Eigen::Quaterniond q(pose.rotation);
    poses_[i].q = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                   static_cast<float>(q.w())};
    poses_[i].p = vector(pose.translation - origin_);
  }

  bool touching(std::size_t i, std::size_t j) {
    AnyPair any;
    return overlap(any, i, j);
  }

  void contacts(std::size_t i, std::size_t j, std::vector<Contact>& found) {
    AllPairs all(mesh(i).getTrianglesRemap(), mesh(j).getTrianglesRemap(), found);
    overlap(all, i, j);
  }

 private:
  struct Release {
    void operator()(physx::PxTriangleMesh* mesh) const { mesh->release(); }
  };

  const physx::PxTriangleMesh& mesh(std::size_t i) const { return *meshes_[i % meshes_.size()]; }

  bool overlap(physx::PxReportCallback<Found>& found, std::size_t i, std::size_t j) const {
    return physx::PxMeshQuery::findOverlapTriangleMesh(
        found, shapes_[i % shapes_.size()], poses_[i], shapes_[j % shapes_.size()], poses_[j],
        physx::PxGeometryQueryFlags(0), physx::PxMeshMeshQueryFlag::eRESERVED3);
  }

  WithoutDenormals without_denormals_;
  std::vector<std::unique_ptr<physx::PxTriangleMesh, Release>> meshes_;
  std::vector<physx::PxTriangleMeshGeometry> shapes_;
  std::vector<physx::PxTransform> poses_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool placed_ = false;
};

}  // namespace

std::span<const Peer> physx_peers() {
  static constexpr Peer list[] = {
      {"physx", "PhysX 5.6: BV4 trees, float32; built by surface area, not quantised",
       "touching contacts", play_peer<PhysxWorld>},
  };
  return list;
}

}  // namespace bvlab
