// SPDX-License-Identifier: BSD-3-Clause
/// A mesh with its hierarchy, standing somewhere. Volumes and triangles are posed when they are
/// first asked for and never twice until the body moves; a body that stays is never posed again.
///
/// All bodies are posed into one frame (the world's, about a common origin), so that what is posed
/// for one pair serves all the others.
#pragma once

#include <cstdint>
#include <new>
#include <vector>

#include "hierarchies/hierarchy.hpp"
#include "traversal/approach.hpp"

namespace bvlab {

template <BoundingVolume V>
class Body {
 public:
  /// Both must outlive the body; `hierarchy` is over `mesh`. Equal meshes share one hierarchy.
  Body(const TriangleMesh& mesh, const Hierarchy<V>& hierarchy)
      : mesh_(&mesh),
        hierarchy_(&hierarchy),
        volumes_(hierarchy.size()),
        volume_epochs_(hierarchy.size() / 2 + 1, 0),
        triangles_(hierarchy.primitives()),
        triangle_epochs_(hierarchy.primitives(), 0) {}

  /// Puts the body where `pose` says; `origin` is the same for all bodies that are to be compared.
  /// Says whether anything moved.
  bool move(const Pose& pose, const Vec3<double>& origin) {
    if (epoch_ > 0 && pose == pose_ && origin == origin_) return false;
    pose_ = pose;
    origin_ = origin;
    if (++epoch_ == 0) forget();
    placed_ = stands_ = false;
    return true;
  }

  const Hierarchy<V>& hierarchy() const { return *hierarchy_; }
  const Pose& pose() const { return pose_; }
  /// The same number means that the body has not moved, unless 2^32 - 1 moves lie between.
  std::uint32_t epoch() const { return epoch_; }
  /// Where it stands. Worked out when it is asked for: a strategy that keeps no margins does not.
  const Stand& stand() {
    if (!stands_) follow();
    return stand_;
  }
  /// How far any of its points can have come from each stand that was asked for to the next, all
  /// together: it grows whenever the body has moved.
  double way() {
    if (!stands_) follow();
    return way_;
  }

  /// Poses the node and its sibling unless that has been done since the body moved.
  template <class Counter>
  void require(std::uint32_t node, Counter& counter) {
    const std::uint32_t siblings = (node + 1) / 2;
    if (volume_epochs_[siblings] == epoch_) return;
    volume_epochs_[siblings] = epoch_;
    if (!placed_) place();
    if (siblings == 0) {
      put(0);
      counter.posed(1);
    } else {
      put(2 * siblings - 1);
      put(2 * siblings);
      counter.posed(2);
    }
  }

  /// The posed volumes; only those that were required stand where the body stands.
  const Posed<V>* volumes() const { return volumes_.data(); }

  /// The triangle at a place of the hierarchy's primitives, in the world.
  const Triangle& triangle(std::uint32_t place) {
    if (triangle_epochs_[place] != epoch_) {
      triangle_epochs_[place] = epoch_;
      const Triangle corners = mesh_->corners(hierarchy_->primitive(place));
      for (int i = 0; i < 3; ++i) triangles_[place][i] = pose_(corners[i]);
    }
    return triangles_[place];
  }

 private:
  /// Made where it is to stand: an assignment would write it, wait for that and copy it.
  void put(std::uint32_t node) {
    ::new (&volumes_[node]) Posed<V>(posed(hierarchy_->volume(node), placement_));
  }

  void place() {
    placement_ = PlacementOf<V>(pose_, origin_, hierarchy_->reach());
    placed_ = true;
  }

  void follow() {
    const Stand stand(pose_, *hierarchy_);
    // Rounded up, so that no step is lost in a long way.
    if (way_ < 0)
      way_ = 0;
    else  // what is no number stays none
      way_ = (way_ + step_between(stand_, stand, hierarchy_->radius())) *
             (1 + 4 * unit_roundoff<double>);
    stand_ = stand;
    stands_ = true;
  }

  void forget() {
    std::fill(volume_epochs_.begin(), volume_epochs_.end(), 0u);
    std::fill(triangle_epochs_.begin(), triangle_epochs_.end(), 0u);
    epoch_ = 1;
  }

  const TriangleMesh* mesh_;
  const Hierarchy<V>* hierarchy_;
  Pose pose_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  PlacementOf<V> placement_;
  bool placed_ = false;  // whether `placement_` is of `pose_`: not where no volume was asked for
  Stand stand_;
  double way_ = -1;      // before the first stand
  bool stands_ = false;  // whether `stand_` is where the body is
  std::uint32_t epoch_ = 0;
  std::vector<Posed<V>> volumes_;
  std::vector<std::uint32_t> volume_epochs_;  // one for two siblings
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_epochs_;
};

}  // namespace bvlab
