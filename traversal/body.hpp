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

/// A body as traversals see it, whatever its volumes.
class TreeBody : public MovingBody {
 public:
  virtual ~TreeBody() = default;

  /// Sets the pose. `origin` must be the same for all bodies that are tested against each other.
  /// Returns whether pose or origin changed. The first call allocates if make_room has not been
  /// called.
  bool move(const Pose& pose, const Vec3<double>& origin) {
    if (triangles_.empty()) make_room();  // before the pose is set, since it may throw
    if (!set_pose(pose, origin)) return false;
    if (epoch_ == 0 || epoch_ >= never_done) forget();
    if (frame_ == Frame::body) return true;
    stamp_ = epoch_;
    is_far_ = !((pose_(extent().origin) - origin_).template lpNorm<1>() <= far_);
    return true;
  }

  /// Allocates the posed volumes and triangles. A body that no other comes near never needs them.
  void make_room() {
    if (frame_ == Frame::world) make_room_for_volumes();
    volumes_posed_.make_room(tree_->sibling_groups(), sharing_);
    if (frame_ == Frame::body) volumes_posed_.all_done(posed_for_good);
    triangles_posed_.make_room(tree_->primitives(), sharing_);
    triangles_.resize(tree_->primitives());
  }

  /// Sets whether several threads use the body from now on.
  void set_sharing(Sharing sharing) {
    sharing_ = sharing;
    volumes_posed_.set_sharing(sharing), triangles_posed_.set_sharing(sharing);
  }

  const TriangleMesh& mesh() const { return *mesh_; }
  const Tree& tree() const { return *tree_; }
  Frame frame() const { return frame_; }

  /// In the world frame, poses the node and its siblings unless that has been done since the last
  /// move. Adds the number of volumes that were posed here to `posed`.
  void require(std::uint32_t node, std::size_t& posed) { require_group(group_(node), posed); }
  /// The same for the children of an inner node.
  void require_children(const Tree::Node& node, std::size_t& posed) {
    require_group(node.group, posed);
  }

  /// The triangle at an index into the tree's primitives, in the world.
  const Triangle& triangle(std::uint32_t index) {
    if (!triangles_posed_.done_alone(index, epoch_)) pose_triangle(index);
    return triangles_[index];
  }

 protected:
  /// Beyond the distance `far` from the origin the body is far.
  TreeBody(const TriangleMesh& mesh, const Tree& tree, Frame frame, double far)
      : MovingBody(tree.extent()),
        tree_(&tree),
        mesh_(&mesh),
        group_(tree),
        frame_(frame),
        far_(far) {
    if (frame_ == Frame::body) stamp_ = posed_for_good;
  }
  TreeBody(const TreeBody&) = default;
  TreeBody& operator=(const TreeBody&) = default;
  TreeBody(TreeBody&&) = default;
  TreeBody& operator=(TreeBody&&) = default;

  virtual void make_room_for_volumes() = 0;
  /// Poses a group of siblings, unless another thread does; returns the number of those posed here.
  virtual std::uint32_t pose_siblings(std::uint32_t siblings) = 0;

  const Tree* tree_;
  std::uint32_t prepared_ = never_done;  // the epoch for which volumes can be posed
  OnceEach volumes_posed_;               // one for each group of siblings
  std::uint32_t stamp_ = 0;

 private:
  void require_group(std::uint32_t siblings, std::size_t& posed) {
    if (!volumes_posed_.done_alone(siblings, stamp_)) posed += pose_siblings(siblings);
  }
  [[gnu::noinline]] void pose_triangle(std::uint32_t index) {
    triangles_posed_(index, epoch_, sharing_, [this, index] {
      const Triangle corners = mesh_->corners(tree_->primitive(index));
      for (int i = 0; i < 3; ++i) triangles_[index][i] = pose_(corners[i]);
    });
  }

  void forget() {
    volumes_posed_.forget(), triangles_posed_.forget();
    if (frame_ == Frame::body) volumes_posed_.all_done(posed_for_good);
    prepared_ = orthonormal_done_ = never_done;
    epoch_ = 1;
  }

  /// The stamp of volumes that never need posing, so that loops need not check the frame.
  static constexpr std::uint32_t posed_for_good = 1;

  const TriangleMesh* mesh_;
  Tree::SiblingGroups group_;
  Frame frame_;
  double far_;
  std::vector<Triangle> triangles_;
  OnceEach triangles_posed_;
};

template <BoundingVolume V>
class Body final : public TreeBody {
 public:
  /// Volumes that are not PlacedRelatively use the world frame, whatever `frame` says. `mesh` and
  /// `hierarchy` must outlive the body; `hierarchy` is over `mesh`. Equal meshes share one
  /// hierarchy.
  Body(const TriangleMesh& mesh, const Hierarchy<V>& hierarchy, Frame frame = Frame::world)
      : TreeBody(mesh, hierarchy, PlacedRelatively<V> ? frame : Frame::world,
                 PlacedRelatively<V> ? far_from_origin<typename V::scalar>(hierarchy.extent())
                                     : std::numeric_limits<double>::infinity()),
        hierarchy_(&hierarchy) {}

  const Hierarchy<V>& hierarchy() const { return *hierarchy_; }
  /// The posed volumes. Only those required since the last move are valid.
  const Posed<V>* volumes() const { return volumes_.data(); }

 private:
  void make_room_for_volumes() override { volumes_.resize(hierarchy_->size()); }
  /// Of a body that is far, only the root is ever read.
  std::uint32_t pose_siblings(std::uint32_t siblings) override {
    const bool is_read = !is_far_ || siblings == 0;
    return volumes_posed_(
               siblings, stamp_, sharing_,
               [this, siblings, is_read] {
                 if (!is_read) return;
                 once(prepared_, epoch_, sharing_,
                      [this] { placement_ = world_placement<V>(pose_, origin_, tree_->extent()); });
                 const auto& [parent, first, count, least] = tree_->above_group(siblings);
                 for (std::uint32_t node = first; node < first + count; ++node) put(node);
               }) &&
                   is_read
               ? tree_->above_group(siblings).count
               : 0;
  }
  /// Constructed in place: assigning a temporary would store it, wait for the store and copy it.
  void put(std::uint32_t node) {
    ::new (&volumes_[node]) Posed<V>(posed(hierarchy_->volume(node), placement_));
  }

  const Hierarchy<V>* hierarchy_;
  PlacementOf<V> placement_;
  std::vector<Posed<V>> volumes_;
};

}  // namespace bvlab
