// SPDX-License-Identifier: BSD-3-Clause
/// Tests of two bodies in each other's frames (RelativeFrame), and the body that they need
/// (WideBody). Volumes stay in the frames of their meshes, and one node at a time is posed
/// into the frame of the other body. No posed volume is kept; the relative pose is formed once per
/// traversal.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <new>

#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/wide/sibling_test.hpp"
#include "hierarchies/wide/wide_hierarchy.hpp"
#include "traversal/reference_sphere.hpp"

namespace bvlab {

/// A mesh with its wide hierarchy at a pose. Vertices are posed on request and not kept.
template <class Hierarchy>
class WideBody {
 public:
  using Tree = Hierarchy;

  WideBody(const TriangleMesh& mesh, const Hierarchy& hierarchy)
      : mesh_(&mesh), hierarchy_(&hierarchy) {}

  const Hierarchy& hierarchy() const { return *hierarchy_; }
  const OrthonormalPose& orthonormal_pose() const { return orthonormal_pose_; }
  const Pose& pose() const { return pose_; }

  /// Returns whether the body has moved.
  bool set_pose(const Pose& pose) {
    if (posed_ && pose == pose_) return false;
    pose_ = pose, posed_ = true;
    orthonormal_pose_ = OrthonormalPose(pose, hierarchy_->reach(), hierarchy_->origin());
    return true;
  }

  /// The mesh's triangle of this index, in the world: every verdict is on these corners.
  Triangle triangle(std::uint32_t index) const { return pose_(mesh_->corners(index)); }

 private:
  const TriangleMesh* mesh_;
  const Hierarchy* hierarchy_;
  Pose pose_;
  OrthonormalPose orthonormal_pose_;
  bool posed_ = false;
};

/// The transforms between the frames of two bodies, a and b, for volumes and for corners. A side is
/// 0 for a and 1 for b.
template <class SiblingTest>
struct TwoFrames {
  using FrameChange = typename SiblingTest::FrameChange;

  std::array<FrameChange, 2> change;         ///< of volumes, INTO the frame of that side
  std::array<CornerTransform, 2> transform;  ///< of corners, FROM the frame of that side

  /// The bodies are WideBody, over any hierarchy.
  template <class Body>
  void begin(const Body& a, const Body& b) {
    const RelativePose a_from_b(a.orthonormal_pose(), b.orthonormal_pose());
    const RelativePose b_from_a(b.orthonormal_pose(), a.orthonormal_pose());
    const double reach_a = a.hierarchy().reach(), reach_b = b.hierarchy().reach();
    put_change(1, a_from_b, a, b);
    put_change(0, b_from_a, b, a);
    transform[0].begin(a_from_b, reach_a, reach_b);
    transform[1].begin(b_from_a, reach_b, reach_a);
  }
  /// Counts volumes of the other side that are posed INTO the frame of `side`.
  template <class Counter>
  [[gnu::always_inline]] void count_posed(Counter& counter, std::size_t side,
                                          std::uint64_t count) const {
    if constexpr (requires { change[side].count_posed(counter, count); })
      change[side].count_posed(counter, count);
    else
      counter.posed(count);
  }

 private:
  /// Constructed in place: a copy in wider pieces than were written would stall.
  template <class Body>
  [[gnu::always_inline]] void put_change(std::size_t side, const RelativePose& pose,
                                         const Body& body, const Body& other) {
    if constexpr (std::constructible_from<FrameChange, const RelativePose&, const Body&,
                                          const Body&>)
      ::new (&change[side]) FrameChange(pose, body, other);
    else
      ::new (&change[side]) FrameChange(
          SiblingTest::frame_change(pose, body.hierarchy().reach(), other.hierarchy().reach()));
  }
};

namespace detail {
template <class V, class Tree>
struct BodyOf {
  using type = WideBody<Tree>;
};
}  // namespace detail
/// A body over a tree of volumes V.
template <class V, class Tree>
using BodyOf = typename detail::BodyOf<V, Tree>::type;

/// Two wide trees and the transforms between their frames. A side is 0 for a and 1 for b.
template <class Body, class SiblingTest>
class FramesOfTrees {
 public:
  using Tree = typename Body::Tree;

  void begin(const Body& a, const Body& b) {
    trees_ = {&a.hierarchy(), &b.hierarchy()};
    frames_.begin(a, b);
  }
  const CornerTransform& a_to_b() const { return frames_.transform[0]; }
  ReferenceSphere reference_sphere(std::size_t side, std::uint32_t node) const {
    return reference_sphere_of(trees_[side]->node_sphere(node), side, frames_.transform);
  }

 protected:
  std::array<const Tree*, 2> trees_;
  TwoFrames<SiblingTest> frames_;
};

/// The tests of two wide trees of one volume.
template <class V, int F>
class RelativeFrame : public FramesOfTrees<WideBody<WideHierarchy<V, F>>, SiblingTestOf<V>> {
  using SiblingTest = SiblingTestOf<V>;
  using T = typename V::scalar;
  using S = Batch<T, F>;
  using Frames = FramesOfTrees<WideBody<WideHierarchy<V, F>>, SiblingTest>;
  using Frames::trees_, Frames::frames_;

 public:
  using PosedNode = typename SiblingTest::PosedNode;

  /// A node of `side`, in the frame of the other side.
  template <class Counter>
  [[gnu::always_inline]] PosedNode posed_node(std::size_t side, std::uint32_t node,
                                              Counter& counter) const {
    counter.posed(1);
    const auto& of = trees_[side]->node(node);
    return SiblingTest::posed_node(of.volume, of.size, frames_.change[1 - side]);
  }
  /// The child of a node of `side` in a lane.
  template <class Counter>
  PosedNode posed_child(std::size_t side, std::uint32_t node, int lane, Counter& counter) const {
    counter.posed(1);
    const auto& of = trees_[side]->children(node);
    return SiblingTest::posed_node(lane_of<V>(of.volumes, lane),
                                   T(of.size[static_cast<std::size_t>(lane)]),
                                   frames_.change[1 - side]);
  }

  /// Tests `posed`, of the other side, against all children of a node of `side`.
  [[gnu::always_inline]] OverlapLanes<S> overlap(std::size_t side, std::uint32_t node,
                                                 const PosedNode& posed) const {
    const auto& lanes = trees_[side]->children(node);
    return SiblingTest::template overlap<S>(posed, frames_.change[side], lanes.volumes,
                                            lanes.size + S(posed.size));
  }
  [[gnu::always_inline]] S gaps(std::size_t side, std::uint32_t node,
                                const PosedNode& posed) const {
    return SiblingTest::template gaps<S>(posed, frames_.change[side],
                                         trees_[side]->children(node).volumes);
  }
  /// A lower bound on the distance to each lane, negative where they may overlap; cheaper than
  /// gaps, and as tight for volumes that are near each other.
  [[gnu::always_inline]] GapLanes<S> separation(std::size_t side, std::uint32_t node,
                                                const PosedNode& posed) const {
    const auto& lanes = trees_[side]->children(node);
    return separation_of<SiblingTest, S>(posed, frames_.change[side], lanes.volumes,
                                         lanes.size + S(posed.size));
  }

  /// What a test of a node's children will read.
  const void* lanes(std::size_t side, std::uint32_t node) const {
    return &trees_[side]->children(node);
  }
};

}  // namespace bvlab
