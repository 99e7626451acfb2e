// SPDX-License-Identifier: BSD-3-Clause
/// Embree's rtcCollide on user geometry, one thread.
#include <embree3/rtcore.h>

#include "broadphase/structures/pair_list.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

class Embree final : public BoxPeer {
 public:
  ~Embree() override {
    if (scene_) rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    boxes_ = boxes;
    pairs_.clear();
    if (boxes.empty()) return pairs_.view();
    if (boxes.size() != count_) enter();
    rtcCommitGeometry(rtcGetGeometry(scene_, 0));
    rtcCommitScene(scene_);
    rtcCollide(
        scene_, scene_,
        [](void* self, RTCCollision* found, unsigned count) {
          auto& peer = *static_cast<Embree*>(self);
          for (unsigned k = 0; k < count; ++k) {
            const auto a = found[k].primID0, b = found[k].primID1;
            if (a < b && overlap<Closed>(peer.boxes_[a], peer.boxes_[b])) peer.pairs_.push({a, b});
          }
        },
        this);
    return pairs_.view();
  }

 private:
  void enter() {
    if (scene_) rtcReleaseScene(scene_);
    count_ = boxes_.size();
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count_));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(
        geometry,
        [](const RTCBoundsFunctionArguments* arguments) {
          const Box<float>& box =
              static_cast<Embree*>(arguments->geometryUserPtr)->boxes_[arguments->primID];
          RTCBounds& b = *arguments->bounds_o;
          b.lower_x = box.lo[0], b.lower_y = box.lo[1], b.lower_z = box.lo[2];
          b.upper_x = box.hi[0], b.upper_y = box.hi[1], b.upper_z = box.hi[2];
        },
        nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, 0);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_ = rtcNewDevice("threads=1,user_threads=0");
  RTCScene scene_ = nullptr;
  std::size_t count_ = 0;
  Boxes<float> boxes_;
  PairList pairs_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  return name == "embree" ? std::make_unique<Embree>() : nullptr;
}

}  // namespace

BoxLibrary embree_boxes() { return {make, {"embree"}}; }

}  // namespace bvlab
