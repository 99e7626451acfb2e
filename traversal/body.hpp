// SPDX-License-Identifier: BSD-3-Clause
/// A mesh with its hierarchy, standing somewhere. Volumes and triangles are posed when they are
/// first asked for and never twice until the body moves; a body that stays is never posed again.
///
/// Several threads may ask a body (see once.hpp); one moves it, while nobody asks.
///
/// All bodies are posed into one frame (the world's, about a common origin), so that what is posed
/// for one pair serves all the others.
#pragma once

#include <cstdint>
#include <new>
#include <vector>

#include "hierarchies/hierarchy.hpp"
#include "traversal/moving_body.hpp"

namespace bvlab {

template <BoundingVolume V>
class Body : public MovingBody {
 public:
  /// Both must outlive the body; `hierarchy` is over `mesh`. Equal meshes share one hierarchy.
  Body(const TriangleMesh& mesh, const Hierarchy<V>& hierarchy)
      : MovingBody(hierarchy.extent()), mesh_(&mesh), hierarchy_(&hierarchy) {}

  /// Puts the body where `pose` says; `origin` is the same for all bodies that are to be compared.
  /// Says whether anything moved. The first call makes room where that has not been done.
  bool move(const Pose& pose, const Vec3<double>& origin) {
    if (!place(pose, origin)) return false;
    if (volumes_.empty()) make_room();
    if (epoch_ == 0 || epoch_ >= never_done) forget();
    return true;
  }

  /// Room for what is posed, which a body that nobody comes near does not need.
  void make_room() {
    volumes_.resize(hierarchy_->size());
    volumes_posed_.make_room(hierarchy_->size() / 2 + 1, askers_);
    triangles_.resize(hierarchy_->primitives());
    triangles_posed_.make_room(hierarchy_->primitives(), askers_);
  }

  /// Who asks from now on, until it is moved: several threads may.
  void asked_by(Askers askers) {
    askers_ = askers;
    volumes_posed_.asked_by(askers), triangles_posed_.asked_by(askers);
  }

  const TriangleMesh& mesh() const { return *mesh_; }
  const Hierarchy<V>& hierarchy() const { return *hierarchy_; }

  /// Poses the node and its sibling unless that has been done since the body moved.
  template <class Counter>
  void require(std::uint32_t node, Counter& counter) {
    const std::uint32_t siblings = (node + 1) / 2;
    if (volumes_posed_.done_alone(siblings, epoch_)) return;
    if (pose_siblings(siblings)) counter.posed(siblings == 0 ? 1 : 2);
  }

  /// How many volumes have been posed since the body moved. O(nodes).
  std::size_t posed_volumes() {
    if (volumes_.empty()) return 0;
    std::size_t count = 0;
    for (std::size_t siblings = 0; siblings < hierarchy_->size() / 2 + 1; ++siblings)
      if (volumes_posed_.done(siblings, epoch_)) count += siblings == 0 ? 1 : 2;
    return count;
  }

  /// The posed volumes; only those that were required stand where the body stands.
  const Posed<V>* volumes() const { return volumes_.data(); }

  /// The triangle at a place of the hierarchy's primitives, in the world.
  const Triangle& triangle(std::uint32_t place) {
    if (!triangles_posed_.done_alone(place, epoch_)) pose_triangle(place);
    return triangles_[place];
  }

 private:
  /// By itself: it is compiled once for all loops, and what calls it stays small. Says whether
  /// nobody else has.
  [[gnu::noinline]] bool pose_siblings(std::uint32_t siblings) {
    return volumes_posed_(siblings, epoch_, askers_, [this, siblings] {
      once(prepared_, epoch_, askers_, [this] { prepare(); });
      if (siblings == 0) return put(0);
      put(2 * siblings - 1);
      put(2 * siblings);
    });
  }

  [[gnu::noinline]] void pose_triangle(std::uint32_t place) {
    triangles_posed_(place, epoch_, askers_, [this, place] {
      const Triangle corners = mesh_->corners(hierarchy_->primitive(place));
      for (int i = 0; i < 3; ++i) triangles_[place][i] = pose_(corners[i]);
    });
  }

  /// Made where it is to stand: an assignment would write it, wait for that and copy it.
  void put(std::uint32_t node) {
    ::new (&volumes_[node]) Posed<V>(posed(hierarchy_->volume(node), placement_));
  }

  void prepare() { placement_ = PlacementOf<V>(pose_, origin_, hierarchy_->extent().reach); }

  void forget() {
    volumes_posed_.forget(), triangles_posed_.forget();
    prepared_ = never_done;
    epoch_ = 1;
  }

  const TriangleMesh* mesh_;
  const Hierarchy<V>* hierarchy_;
  PlacementOf<V> placement_;
  std::uint32_t prepared_ = never_done;  // the epoch that `placement_` is of
  std::vector<Posed<V>> volumes_;
  OnceEach volumes_posed_;  // one for two siblings
  std::vector<Triangle> triangles_;
  OnceEach triangles_posed_;
};

}  // namespace bvlab
