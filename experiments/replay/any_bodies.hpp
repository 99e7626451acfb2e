// SPDX-License-Identifier: BSD-3-Clause
/// Bodies whose volume is chosen by name while the program runs. Volumes and strategies meet here,
/// so that neither is compiled for the other.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "experiments/replay/hierarchies_by_mesh.hpp"
#include "traversal/body_pair.hpp"
#include "traversal/counters.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

/// Bodies of a volume that is known inside alone. What is not documented here is as in `Bodies`.
template <class Query>
class BodiesInside {
 public:
  /// Pairs of volumes that are tested at once.
  static constexpr int W = native_width<float>;

  virtual ~BodiesInside() = default;
  virtual std::size_t size() const = 0;
  virtual TreeBody& body(std::size_t i) = 0;
  virtual void add(const OneOfHierarchies& of_mesh) = 0;
  virtual TestsBetween<Query> tests_between() const = 0;
  virtual void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                          Query& query, Counting& counter, std::uint8_t* apart) = 0;
};

/// The same as `AllPairsOf` and `StrategyPairs` take them.
template <class Query>
class AnyBodies {
 public:
  static constexpr bool culls_in_batches = BodiesInside<Query>::W > 1;

  explicit AnyBodies(std::unique_ptr<BodiesInside<Query>> inside)
      : inside_(std::move(inside)), tests_between_(inside_->tests_between()) {
    find_bodies();
  }

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return bodies_[i]->mesh(); }
  const Vec3<double>& mesh_origin(std::size_t i) const { return bodies_[i]->extent().origin; }
  TreeBody& operator[](std::size_t i) const { return *bodies_[i]; }
  TestsBetween<Query> tests_between() const { return tests_between_; }
  void add(const OneOfHierarchies& of_mesh) {
    inside_->add(of_mesh);
    find_bodies();
    bodies_.back()->set_sharing(sharing_);
  }
  void make_room() {
    for (TreeBody* body : bodies_) body->make_room();
  }
  void set_sharing(Sharing sharing) {
    sharing_ = sharing;
    for (TreeBody* body : bodies_) body->set_sharing(sharing);
  }
  void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) {
    bodies_[i]->move(pose, origin);
  }
  void move(std::span<const Pose> poses, const Vec3<double>& origin) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i]->move(poses[i], origin);
  }
  template <class Counter>
  PairOfBodies<BodiesInside<Query>::W, Query, Counter> pair(const ObjectPair& pair, Query& query,
                                                            Counter& counter) {
    static thread_local Workspace workspace;
    return {*bodies_[pair.i], *bodies_[pair.j], tests_between_, query, counter, workspace};
  }
  void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                  Query& query, Counting& counter, std::uint8_t* apart) {
    inside_->cull_roots(pairs, fresh, query, counter, apart);
  }

 private:
  /// Bodies may have gone elsewhere.
  void find_bodies() {
    bodies_.clear();
    for (std::size_t i = 0; i < inside_->size(); ++i) bodies_.push_back(&inside_->body(i));
  }

  std::unique_ptr<BodiesInside<Query>> inside_;
  TestsBetween<Query> tests_between_;
  std::vector<TreeBody*> bodies_;
  Sharing sharing_ = Sharing::one_thread;
};

}  // namespace bvlab
