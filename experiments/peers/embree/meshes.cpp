// SPDX-License-Identifier: BSD-3-Clause
/// Embree's collision of two scenes of user geometry. It knows no moving scene: the triangles of a
/// body that moved get new boxes in the world and its tree is refitted, which is part of its time.
#include <embree3/rtcore.h>

#include <optional>

#include "experiments/peers/play_peer.hpp"
#include "experiments/replay/triangle_test.hpp"

namespace bvlab {
namespace {

/// One body: its triangles, posed in the world, and Embree's tree over their boxes.
class PosedMesh {
 public:
  PosedMesh(RTCDevice device, const TriangleMesh& mesh)
      : mesh_(mesh), triangles_(mesh.triangles.size()), scene_(rtcNewScene(device)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    stand(Pose{});
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(triangles_.size()));
    rtcSetGeometryUserData(geometry, triangles_.data());
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, 0);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  PosedMesh(const PosedMesh&) = delete;
  PosedMesh& operator=(const PosedMesh&) = delete;
  ~PosedMesh() { rtcReleaseScene(scene_); }

  void place(const Pose& pose) {
    if (pose_ == pose) return;
    stand(pose);
    rtcCommitGeometry(rtcGetGeometry(scene_, 0));
    rtcCommitScene(scene_);
  }

  RTCScene scene() const { return scene_; }
  const Triangle& triangle(unsigned i) const { return triangles_[i]; }

 private:
  void stand(const Pose& pose) {
    pose_ = pose;
    vertices_.resize(mesh_.vertices.size());
    for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v] = pose(mesh_.vertices[v]);
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (int k = 0; k < 3; ++k)
        triangles_[t][static_cast<std::size_t>(k)] =
            vertices_[mesh_.triangles[t][static_cast<std::size_t>(k)]];
  }

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const Triangle& t = static_cast<const Triangle*>(arguments->geometryUserPtr)[arguments->primID];
    const Vec3<double> low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
    const Vec3<double> high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    RTCBounds& box = *arguments->bounds_o;
    box.lower_x = rounded_down<float>(low[0]), box.upper_x = rounded_up<float>(high[0]);
    box.lower_y = rounded_down<float>(low[1]), box.upper_y = rounded_up<float>(high[1]);
    box.lower_z = rounded_down<float>(low[2]), box.upper_z = rounded_up<float>(high[2]);
  }

  const TriangleMesh& mesh_;
  std::optional<Pose> pose_;
  std::vector<Vec3<double>> vertices_;
  std::vector<Triangle> triangles_;
  RTCScene scene_;
};

class EmbreeWorld {
 public:
  EmbreeWorld(std::span<const TriangleMesh> meshes, std::size_t objects)
      : device_(rtcNewDevice("threads=1,user_threads=0")) {
    for (std::size_t i = 0; i < objects; ++i)
      bodies_.push_back(std::make_unique<PosedMesh>(device_, meshes[i % meshes.size()]));
  }
  EmbreeWorld(const EmbreeWorld&) = delete;
  EmbreeWorld& operator=(const EmbreeWorld&) = delete;
  ~EmbreeWorld() {
    bodies_.clear();
    rtcReleaseDevice(device_);
  }

  void place(std::size_t i, const Pose& pose) { bodies_[i]->place(pose); }

  /// Embree goes on after the first hit; our test of triangles does not.
  bool touching(std::size_t i, std::size_t j) {
    Pair pair{*bodies_[i], *bodies_[j]};
    rtcCollide(
        pair.a.scene(), pair.b.scene(),
        [](void* data, RTCCollision* met, unsigned count) {
          auto& pair = *static_cast<Pair*>(data);
          for (unsigned k = 0; k < count && !pair.touching; ++k)
            pair.touching =
                intersect(pair.a.triangle(met[k].primID0), pair.b.triangle(met[k].primID1));
        },
        &pair);
    return pair.touching;
  }

  void contacts(std::size_t i, std::size_t j, std::vector<Contact>& found) {
    Pair pair{*bodies_[i], *bodies_[j], &found};
    rtcCollide(
        pair.a.scene(), pair.b.scene(),
        [](void* data, RTCCollision* met, unsigned count) {
          auto& pair = *static_cast<Pair*>(data);
          for (unsigned k = 0; k < count; ++k)
            if (intersect(pair.a.triangle(met[k].primID0), pair.b.triangle(met[k].primID1)))
              pair.found->push_back({met[k].primID0, met[k].primID1});
        },
        &pair);
  }

 private:
  struct Pair {
    const PosedMesh &a, &b;
    std::vector<Contact>* found = nullptr;
    bool touching = false;
  };

  RTCDevice device_;
  std::vector<std::unique_ptr<PosedMesh>> bodies_;
};

}  // namespace

std::span<const Peer> embree_peers() {
  static constexpr Peer list[] = {
      {"embree",
       "Embree 3.13.5: rtcCollide, one thread, with our exact test of triangles; the scene of a "
       "body that moved is refitted",
       "touching contacts", play_peer<EmbreeWorld>},
  };
  return list;
}

}  // namespace bvlab
