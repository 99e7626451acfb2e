// SPDX-License-Identifier: BSD-3-Clause
/// A mesh with its hierarchy, in a pose. Volumes and triangles are posed when they are first
/// needed, at most once between two moves; a body that does not move is never posed again.
///
/// Several threads may query a body at once (see once.hpp), but it must be moved by one thread,
/// while no other uses it.
///
/// In a body's frame no volume is posed here (see frame.hpp), nor far from the origin (is_far).
#pragma once

#include <cstdint>
#include <new>
#include <vector>

#include "hierarchies/hierarchy.hpp"
#include "hierarchies/relative_placement.hpp"
#include "traversal/frame.hpp"
#include "traversal/moving_body.hpp"

namespace bvlab {

template <BoundingVolume V>
class Body : public MovingBody {
 public:
  /// Volumes that are not PlacedRelatively use the world frame, whatever `frame` says. `mesh` and
  /// `hierarchy` must outlive the body; `hierarchy` is over `mesh`. Equal meshes share one
  /// hierarchy.
  Body(const TriangleMesh& mesh, const Hierarchy<V>& hierarchy, Frame frame = Frame::world)
      : MovingBody(hierarchy.extent()),
        mesh_(&mesh),
        hierarchy_(&hierarchy),
        group_(hierarchy),
        frame_(PlacedRelatively<V> ? frame : Frame::world) {
    if (frame_ == Frame::body) stamp_ = posed_for_good;
    far_ = far_from_origin<typename V::scalar>(hierarchy.extent());
  }

  /// Sets the pose. `origin` must be the same for all bodies that are tested against each other.
  /// Returns whether pose or origin changed. The first call allocates if make_room has not been
  /// called.
  bool move(const Pose& pose, const Vec3<double>& origin) {
    if (triangles_.empty()) make_room();  // before the pose is set, since it may throw
    if (!set_pose(pose, origin)) return false;
    if (epoch_ == 0 || epoch_ >= never_done) forget();
    if (frame_ == Frame::body) return true;
    stamp_ = epoch_;
    if constexpr (PlacedRelatively<V>)
      is_far_ = !((pose_(extent().origin) - origin_).template lpNorm<1>() <= far_);
    return true;
  }

  /// Allocates the posed volumes and triangles. A body that no other comes near never needs them.
  void make_room() {
    if (frame_ == Frame::world) volumes_.resize(hierarchy_->size());
    volumes_posed_.make_room(hierarchy_->sibling_groups(), sharing_);
    if (frame_ == Frame::body) volumes_posed_.all_done(posed_for_good);
    triangles_posed_.make_room(hierarchy_->primitives(), sharing_);
    triangles_.resize(hierarchy_->primitives());
  }

  /// Sets whether several threads use the body from now on.
  void set_sharing(Sharing sharing) {
    sharing_ = sharing;
    volumes_posed_.set_sharing(sharing), triangles_posed_.set_sharing(sharing);
  }

  const TriangleMesh& mesh() const { return *mesh_; }
  const Hierarchy<V>& hierarchy() const { return *hierarchy_; }
  Frame frame() const { return frame_; }

  /// In the world frame, poses the node and its siblings unless that has been done since the last
  /// move.
  template <class Counter>
  void require(std::uint32_t node, Counter& counter) {
    const std::uint32_t siblings = group_(node);
    if (volumes_posed_.done_alone(siblings, stamp_)) return;
    if (pose_siblings(siblings)) counter.posed(in_group(siblings));
  }

  /// The same for the children of an inner node.
  template <class Counter>
  void require_children(const typename Hierarchy<V>::Node& node, Counter& counter) {
    if (volumes_posed_.done_alone(node.group, stamp_)) return;
    if (pose_siblings(node.group)) counter.posed(node.children);
  }

  /// How many volumes have been posed since the body moved. O(nodes).
  std::size_t posed_volumes() {
    if (volumes_.empty()) return 0;
    if (is_far_) return volumes_posed_.done(0, stamp_);
    std::size_t count = 0;
    for (std::uint32_t siblings = 0; siblings < hierarchy_->sibling_groups(); ++siblings)
      if (volumes_posed_.done(siblings, stamp_)) count += in_group(siblings);
    return count;
  }

  /// The posed volumes. Only those required since the last move are valid.
  const Posed<V>* volumes() const { return volumes_.data(); }

  /// The triangle at an index into the hierarchy's primitives, in the world.
  const Triangle& triangle(std::uint32_t index) {
    if (!triangles_posed_.done_alone(index, epoch_)) pose_triangle(index);
    return triangles_[index];
  }

 private:
  /// Out of line: it is compiled once for all loops, and its callers stay small. Returns whether
  /// this thread posed them. Of a body that is far, only the root is ever read.
  [[gnu::noinline]] bool pose_siblings(std::uint32_t siblings) {
    return volumes_posed_(siblings, stamp_, sharing_, [this, siblings] {
      if (is_far_ && siblings > 0) return;
      once(prepared_, epoch_, sharing_, [this] { prepare(); });
      const auto& [parent, first, count, least] = hierarchy_->above_group(siblings);
      for (std::uint32_t node = first; node < first + count; ++node) put(node);
    }) && !(is_far_ && siblings > 0);
  }
  std::uint32_t in_group(std::uint32_t siblings) const {
    return hierarchy_->above_group(siblings).count;
  }

  [[gnu::noinline]] void pose_triangle(std::uint32_t index) {
    triangles_posed_(index, epoch_, sharing_, [this, index] {
      const Triangle corners = mesh_->corners(hierarchy_->primitive(index));
      for (int i = 0; i < 3; ++i) triangles_[index][i] = pose_(corners[i]);
    });
  }

  /// Constructed in place: assigning a temporary would store it, wait for the store and copy it.
  void put(std::uint32_t node) {
    ::new (&volumes_[node]) Posed<V>(posed(hierarchy_->volume(node), placement_));
  }

  void prepare() { placement_ = world_placement<V>(pose_, origin_, hierarchy_->extent()); }

  void forget() {
    volumes_posed_.forget(), triangles_posed_.forget();
    if (frame_ == Frame::body) volumes_posed_.all_done(posed_for_good);
    prepared_ = orthonormal_done_ = never_done;
    epoch_ = 1;
  }

  /// The stamp of volumes that never need posing, so that loops need not check the frame.
  static constexpr std::uint32_t posed_for_good = 1;

  const TriangleMesh* mesh_;
  const Hierarchy<V>* hierarchy_;
  typename Hierarchy<V>::SiblingGroups group_;
  PlacementOf<V> placement_;
  std::uint32_t prepared_ = never_done;  // the epoch of `placement_`
  std::vector<Posed<V>> volumes_;
  OnceEach volumes_posed_;  // one for each group of siblings
  std::uint32_t stamp_ = 0;
  Frame frame_;
  double far_;  // the distance from the origin beyond which the body is far
  std::vector<Triangle> triangles_;
  OnceEach triangles_posed_;
};

}  // namespace bvlab
