// SPDX-License-Identifier: BSD-3-Clause
/// ODE's hash space and its sweep and prune. A geometry is a box with a centre and three lengths,
/// so its bounds are rounded anew; each pair reported is compared with the boxes themselves.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>

#include "broadphase/structures/pair_list.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

class Ode final : public BoxPeer {
 public:
  enum class Kind { hash, sweep };
  explicit Ode(Kind kind) : kind_(kind) {
    static const bool ready = dInitODE2(0) && dAllocateODEDataForThread(dAllocateMaskAll);
    (void)ready;
  }
  ~Ode() override {
    if (space_) dSpaceDestroy(space_);
  }

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    boxes_ = boxes;
    if (boxes.size() != geometries_.size()) enter();
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      const Box<float>& b = boxes[k];
      double centre[3], length[3];
      for (int axis = 0; axis < 3; ++axis) {
        centre[axis] = (double(b.lo[axis]) + double(b.hi[axis])) / 2;
        // A little longer than the box, so that no rounding loses what touches.
        length[axis] = (double(b.hi[axis]) - double(b.lo[axis])) * (1 + 1e-6) +
                       std::abs(centre[axis]) * 1e-6 + 1e-30;
      }
      dGeomBoxSetLengths(geometries_[k], length[0], length[1], length[2]);
      dGeomSetPosition(geometries_[k], centre[0], centre[1], centre[2]);
    }
    pairs_.clear();
    dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) {
      auto& peer = *static_cast<Ode*>(self);
      const Pair pair = ordered(index(a), index(b));
      if (overlap<Closed>(peer.boxes_[pair.i], peer.boxes_[pair.j])) peer.pairs_.push(pair);
    });
    return pairs_.view();
  }

 private:
  static std::uint32_t index(dGeomID geometry) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(dGeomGetData(geometry)));
  }
  void enter() {
    if (space_) dSpaceDestroy(space_);
    geometries_.clear();
    space_ = kind_ == Kind::hash ? dHashSpaceCreate(nullptr)
                                 : dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      geometries_.push_back(dCreateBox(space_, 1, 1, 1));
      dGeomSetData(geometries_.back(), reinterpret_cast<void*>(k));
    }
  }

  Kind kind_;
  dSpaceID space_ = nullptr;
  Boxes<float> boxes_;
  std::vector<dGeomID> geometries_;
  PairList pairs_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "ode-hash") return std::make_unique<Ode>(Ode::Kind::hash);
  if (name == "ode-sap") return std::make_unique<Ode>(Ode::Kind::sweep);
  return nullptr;
}

}  // namespace

BoxLibrary ode_boxes() { return {make, {"ode-hash", "ode-sap"}}; }

}  // namespace bvlab
