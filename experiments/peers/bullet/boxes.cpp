// SPDX-License-Identifier: BSD-3-Clause
/// Bullet's dynamic trees and its incremental sweep. The pairs of its cache are those of widened
/// boxes, so each is compared once more with the boxes themselves.
///
/// The trees widen a box that moves by `gDbvtMargin`, 0.05 units, which suits boxes of about one
/// unit. Boxes a hundredth as large would each meet hundreds of others, so it is a twentieth of the
/// boxes' mean edge here.
#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <algorithm>
#include <cmath>

#include "broadphase/structures/pair_list.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

btVector3 vector(const float* x) { return {x[0], x[1], x[2]}; }

class Bullet final : public BoxPeer {
 public:
  enum class Kind { trees, sweep };
  explicit Bullet(Kind kind) : kind_(kind) {}
  ~Bullet() override { release(); }

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    if (boxes.size() != proxies_.size()) {
      enter(boxes);
    } else {
      const Margin margin(margin_);
      for (std::uint32_t k = 0; k < boxes.size(); ++k) place(k, boxes[k]);
    }
    return found(boxes);
  }

  std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t> moved) override {
    if (boxes.size() != proxies_.size()) return overlapping(boxes);
    const Margin margin(margin_);
    for (const std::uint32_t k : moved) place(k, boxes[k]);
    return found(boxes);
  }
  bool takes_moved() const override { return true; }

 private:
  /// Bullet's margin, a variable of the library, while boxes are placed.
  class Margin {
   public:
    explicit Margin(btScalar margin) : before_(gDbvtMargin) { gDbvtMargin = margin; }
    ~Margin() { gDbvtMargin = before_; }
    Margin(const Margin&) = delete;
    Margin& operator=(const Margin&) = delete;

   private:
    btScalar before_;
  };

  void place(std::uint32_t k, const Box<float>& box) {
    broadphase_->setAabb(proxies_[k], vector(box.lo), vector(box.hi), nullptr);
  }
  std::span<const Pair> found(Boxes<float> boxes) {
    broadphase_->calculateOverlappingPairs(nullptr);
    pairs_.clear();
    const auto& cache = broadphase_->getOverlappingPairCache()->getOverlappingPairArray();
    for (int k = 0; k < cache.size(); ++k) {
      const Pair pair = ordered(index(cache[k].m_pProxy0), index(cache[k].m_pProxy1));
      if (overlap<Closed>(boxes[pair.i], boxes[pair.j])) pairs_.push(pair);
    }
    return pairs_.view();
  }

  static std::uint32_t index(btBroadphaseProxy* proxy) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(proxy->m_clientObject)) - 1;
  }
  void enter(Boxes<float> boxes) {
    release();
    double edges = 0;
    for (const auto& box : boxes)
      for (int axis = 0; axis < 3; ++axis) edges += box.hi[axis] - box.lo[axis];
    const double margin = 0.05 * edges / (3 * std::max<double>(boxes.size(), 1));
    margin_ = static_cast<btScalar>(std::isfinite(margin) ? margin : 0.05);
    Box<float> all = boxes.empty() ? Box<float>{} : boxes[0];
    for (const auto& box : boxes)
      for (int axis = 0; axis < 3; ++axis) {
        all.lo[axis] = std::min(all.lo[axis], box.lo[axis]);
        all.hi[axis] = std::max(all.hi[axis], box.hi[axis]);
      }
    // The sweep cuts the world into integer steps: room for boxes to move.
    for (int axis = 0; axis < 3; ++axis) {
      const float room = all.hi[axis] - all.lo[axis] + 1e-3f;
      all.lo[axis] -= room, all.hi[axis] += room;
    }
    if (kind_ == Kind::trees)
      broadphase_ = std::make_unique<btDbvtBroadphase>();
    else
      broadphase_ = std::make_unique<bt32BitAxisSweep3>(vector(all.lo), vector(all.hi),
                                                        static_cast<unsigned>(boxes.size()) + 2);
    for (std::uint32_t k = 0; k < boxes.size(); ++k)
      proxies_.push_back(broadphase_->createProxy(
          vector(boxes[k].lo), vector(boxes[k].hi), 0,
          reinterpret_cast<void*>(static_cast<std::uintptr_t>(k + 1)), 1, 1, nullptr));
  }
  void release() {
    // Without pairs first: each proxy that is destroyed has all pairs searched for its own.
    if (broadphase_) broadphase_->getOverlappingPairCache()->getOverlappingPairArray().clear();
    for (auto* proxy : proxies_) broadphase_->destroyProxy(proxy, nullptr);
    proxies_.clear();
    broadphase_.reset();
  }

  Kind kind_;
  btScalar margin_ = 0;
  std::unique_ptr<btBroadphaseInterface> broadphase_;
  std::vector<btBroadphaseProxy*> proxies_;
  PairList pairs_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "bullet-dbvt") return std::make_unique<Bullet>(Bullet::Kind::trees);
  if (name == "bullet-sweep") return std::make_unique<Bullet>(Bullet::Kind::sweep);
  return nullptr;
}

}  // namespace

BoxLibrary bullet_boxes() { return {make, {"bullet-dbvt", "bullet-sweep"}}; }

}  // namespace bvlab
