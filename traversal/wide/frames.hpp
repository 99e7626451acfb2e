// SPDX-License-Identifier: BSD-3-Clause
/// THE list of frames of comparison: where two volumes stand when they are tested.
///
/// A frame's `Body<V, F>` stands somewhere; its `Between<V, F>` is two of them, whose sides are 0
/// and 1:
///   begin(a, b)                            looks at two bodies
///   one(side, node), one_child(...)        one volume, ready to be tested
///   compared(side, node, one), gaps(...)   tests it against the children of a node of `side`
///   corners()                              takes corners of a to where b's mesh is given
///   place(side, node)                      a ball around a node, as both bodies have it
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/geometry/type_list.hpp"
#include "hierarchies/wide/facing.hpp"
#include "hierarchies/wide/wide_hierarchy.hpp"

namespace bvlab {

/// What bodies have in common: vertices are posed when they are asked for, and not kept.
template <BoundingVolume V, int F>
class WideBody {
 public:
  WideBody(const TriangleMesh& mesh, const WideHierarchy<V, F>& hierarchy)
      : mesh_(&mesh), hierarchy_(&hierarchy) {}

  const WideHierarchy<V, F>& hierarchy() const { return *hierarchy_; }
  const OrthonormalPose& orthonormal_pose() const { return orthonormal_pose_; }
  const Pose& pose() const { return pose_; }

  /// Says whether it has moved.
  bool stand(const Pose& pose) {
    if (placed_ && pose == pose_) return false;
    pose_ = pose, placed_ = true;
    orthonormal_pose_ = OrthonormalPose(pose, hierarchy_->reach());
    return true;
  }

  /// In the world: what every verdict is on.
  Triangle triangle(std::uint32_t index) const {
    Triangle corners = mesh_->corners(index);
    for (auto& corner : corners) corner = pose_(corner);
    return corners;
  }

 private:
  const TriangleMesh* mesh_;
  const WideHierarchy<V, F>* hierarchy_;
  Pose pose_;
  OrthonormalPose orthonormal_pose_;
  bool placed_ = false;
};

/// Corners of a, where b's mesh is given: for the filter of triangles, whatever volumes do.
class CornersBetween {
 public:
  using Four = Batch<float, 4>;

  /// Corners are rounded (e r), as are rotation and translation; then come three products and sums.
  void begin(const RelativePose& a_from_b, double reach_a, double reach_b) {
    constexpr double e = unit_roundoff<float>;
    off_ = static_cast<float>(
               (16 * e * (reach_a + a_from_b.length) + 2 * e * reach_b + a_from_b.noise) *
               (1 + 8 * e)) +
           std::numeric_limits<float>::min();
    for (int i = 0; i < 3; ++i)
      rounded_to_float(a_from_b.column[static_cast<std::size_t>(i)])
          .copy_to(column_[i], stdx::vector_aligned);
    rounded_to_float(a_from_b.translation).copy_to(translation_, stdx::vector_aligned);
  }

  /// The fourth number is none of its coordinates.
  [[gnu::always_inline]] Four turned(float x, float y, float z) const {
    const auto from = [](const float* p) { return Four(p, stdx::vector_aligned); };
    return fused<Four>(from(column_[2]), Four(z),
                       fused<Four>(from(column_[1]), Four(y),
                                   fused<Four>(from(column_[0]), Four(x), from(translation_))));
  }

  /// The same of several points.
  template <Batched S>
  [[gnu::always_inline]] std::array<S, 3> turned(const S& x, const S& y, const S& z) const {
    std::array<S, 3> turned;
    for (std::size_t i = 0; i < 3; ++i)
      turned[i] = fused<S>(
          S(column_[2][i]), z,
          fused<S>(S(column_[1][i]), y, fused<S>(S(column_[0][i]), x, S(translation_[i]))));
    return turned;
  }

  /// How far any corner can be from where it is said to be, in each coordinate.
  float off() const { return off_; }

 private:
  alignas(16) float column_[3][4], translation_[4];
  float off_;
};

/// A ball around some of the triangles of a or b, and where its middle is.
struct Place {
  alignas(16) std::array<float, 4> of_a, of_b;  ///< where each mesh is given; the last is none
  float radius, off;                            ///< in each coordinate, at most
};

template <class Ball>
[[gnu::always_inline]] inline Place place_between(const Ball& ball, std::size_t side,
                                                  const std::array<CornersBetween, 2>& corners) {
  Place place;
  auto &own = side == 0 ? place.of_a : place.of_b, &other = side == 0 ? place.of_b : place.of_a;
  std::copy_n(ball.middle, 3, own.begin());
  corners[side]
      .turned(ball.middle[0], ball.middle[1], ball.middle[2])
      .copy_to(other.data(), stdx::vector_aligned);
  place.radius = ball.radius, place.off = corners[side].off();
  return place;
}

/// Bodies stay as their meshes are given; the relative pose takes one node at a time into the frame
/// of the other. A body is its pose.
struct RelativeFrame {
  static constexpr std::string_view name = "relative";
  static constexpr std::string_view description =
      "one body's node is posed into the frame of the other, whose nodes never are";

  template <BoundingVolume V, int F>
  using Body = WideBody<V, F>;

  template <BoundingVolume V, int F>
  class Between {
    using Facing = FacingOf<V>;
    using T = typename V::scalar;
    using S = Batch<T, F>;

   public:
    using One = typename Facing::One;

    void begin(Body<V, F>& a, Body<V, F>& b) {
      hierarchies_ = {&a.hierarchy(), &b.hierarchy()};
      const RelativePose a_from_b(a.orthonormal_pose(), b.orthonormal_pose());
      const double reach_a = a.hierarchy().reach(), reach_b = b.hierarchy().reach();
      const RelativePose b_from_a(b.orthonormal_pose(), a.orthonormal_pose());
      // In place: what is copied in larger pieces than it was written in is waited for.
      using FrameChange = typename Facing::FrameChange;
      ::new (&frame_change_[1]) FrameChange(Facing::frame_change(a_from_b, reach_a, reach_b));
      ::new (&frame_change_[0]) FrameChange(Facing::frame_change(b_from_a, reach_b, reach_a));
      corners_[0].begin(a_from_b, reach_a, reach_b);
      corners_[1].begin(b_from_a, reach_b, reach_a);
    }

    /// A volume of `side`, for the other side's lanes.
    template <class Counter>
    [[gnu::always_inline]] One one(std::size_t side, std::uint32_t node, Counter& counter) const {
      counter.posed(1);
      const auto& of = hierarchies_[side]->node(node);
      return Facing::one(of.volume, of.size, frame_change_[1 - side]);
    }
    /// One child of a node.
    template <class Counter>
    One one_child(std::size_t side, std::uint32_t node, int lane, Counter& counter) const {
      counter.posed(1);
      const auto& of = hierarchies_[side]->children(node);
      return Facing::one(lane_of<V>(of.volumes, lane), T(of.size[static_cast<std::size_t>(lane)]),
                         frame_change_[1 - side]);
    }
    template <class Counter>
    [[gnu::always_inline]] Compared<S> compared(std::size_t side, std::uint32_t node,
                                                const One& one, Counter&) const {
      const auto& lanes = hierarchies_[side]->children(node);
      return Facing::template compared<S>(one, frame_change_[side], lanes.volumes, lanes.size);
    }
    template <class Counter>
    [[gnu::always_inline]] S gaps(std::size_t side, std::uint32_t node, const One& one,
                                  Counter&) const {
      return Facing::template gaps<S>(one, frame_change_[side],
                                      hierarchies_[side]->children(node).volumes);
    }
    /// How far it is from each lane, at least, negative where they may meet; cheaper than gaps, and
    /// as near to the truth where they hardly meet.
    template <class Counter>
    [[gnu::always_inline]] Separated<S> separated(std::size_t side, std::uint32_t node,
                                                  const One& one, Counter& counter) const {
      const auto& lanes = hierarchies_[side]->children(node);
      if constexpr (requires {
                      Facing::template separation<S>(one, frame_change_[side], lanes.volumes);
                    }) {
        const S gap = Facing::template separation<S>(one, frame_change_[side], lanes.volumes);
        return {gap, gap * roughly_one_over<S>(lanes.size + S(one.size))};
      } else {
        return {gaps(side, node, one, counter), compared(side, node, one, counter).order};
      }
    }
    const CornersBetween& corners() const { return corners_[0]; }
    Place place(std::size_t side, std::uint32_t node) const {
      return place_between(hierarchies_[side]->place(node), side, corners_);
    }

   private:
    std::array<const WideHierarchy<V, F>*, 2> hierarchies_;
    std::array<typename Facing::FrameChange, 2> frame_change_;  // into the frame of that side
    std::array<CornersBetween, 2> corners_;                     // of a to b, and back
  };
};

/// Both bodies are posed into the world, about a common origin: a node with all its children, once
/// whenever its body has moved, for all pairs.
struct WorldFrame {
  static constexpr std::string_view name = "world";
  static constexpr std::string_view description =
      "both bodies are posed into the world, each node once whenever its body has moved";

  template <BoundingVolume V, int F>
  class Body : public WideBody<V, F> {
    using S = Batch<typename V::scalar, F>;

   public:
    Body(const TriangleMesh& mesh, const WideHierarchy<V, F>& hierarchy)
        : WideBody<V, F>(mesh, hierarchy),
          nodes_(hierarchy.size()),
          lanes_(hierarchy.size()),
          node_epochs_(hierarchy.size(), 0),
          lane_epochs_(hierarchy.size(), 0) {}

    void place(const Pose& pose, const Vec3<double>& origin) {
      if (!this->stand(pose)) return;
      placement_ = PlacementOf<V>(pose, origin, this->hierarchy().reach());
      if (++epoch_ == 0) {
        std::fill(node_epochs_.begin(), node_epochs_.end(), 0u);
        std::fill(lane_epochs_.begin(), lane_epochs_.end(), 0u);
        epoch_ = 1;
      }
    }

    template <class Counter>
    const Posed<V>& node(std::uint32_t i, Counter& counter) {
      if (std::exchange(node_epochs_[i], epoch_) != epoch_) {
        ::new (&nodes_[i]) Posed<V>(posed(this->hierarchy().node(i).volume, placement_));
        counter.posed(1);
      }
      return nodes_[i];
    }
    template <class Counter>
    const Over<Posed<V>, S>& lanes(std::uint32_t i, Counter& counter) {
      if (std::exchange(lane_epochs_[i], epoch_) != epoch_) {
        const auto& children = this->hierarchy().children(i).volumes;
        ::new (&lanes_[i]) Over<Posed<V>, S>(posed(children, placement_));
        counter.posed(static_cast<std::uint64_t>(std::popcount(this->hierarchy().node(i).lanes)));
      }
      return lanes_[i];
    }

   private:
    PlacementOf<V> placement_;
    std::vector<Posed<V>> nodes_;
    std::vector<Over<Posed<V>, S>> lanes_;
    std::vector<std::uint32_t> node_epochs_, lane_epochs_;
    std::uint32_t epoch_ = 0;
  };

  template <BoundingVolume V, int F>
  class Between {
    using T = typename V::scalar;
    using S = Batch<T, F>;

   public:
    struct One {
      Over<Posed<V>, S> volume;
      S size;
    };

    void begin(Body<V, F>& a, Body<V, F>& b) {
      bodies_ = {&a, &b};
      const double reach_a = a.hierarchy().reach(), reach_b = b.hierarchy().reach();
      corners_[0].begin(RelativePose(a.orthonormal_pose(), b.orthonormal_pose()), reach_a, reach_b);
      corners_[1].begin(RelativePose(b.orthonormal_pose(), a.orthonormal_pose()), reach_b, reach_a);
    }

    template <class Counter>
    One one(std::size_t side, std::uint32_t node, Counter& counter) const {
      return {in_all_lanes<S>(bodies_[side]->node(node, counter)),
              S(bodies_[side]->hierarchy().node(node).size)};
    }
    template <class Counter>
    One one_child(std::size_t side, std::uint32_t node, int lane, Counter& counter) const {
      const auto volume = lane_of<Posed<V>>(bodies_[side]->lanes(node, counter), lane);
      const auto& sizes = bodies_[side]->hierarchy().children(node).size;
      return {in_all_lanes<S>(volume), S(T(sizes[static_cast<std::size_t>(lane)]))};
    }
    template <class Counter>
    Compared<S> compared(std::size_t side, std::uint32_t node, const One& one,
                         Counter& counter) const {
      return detail::compared_posed<S>(one.volume, bodies_[side]->lanes(node, counter), one.size,
                                       bodies_[side]->hierarchy().children(node).size);
    }
    template <class Counter>
    S gaps(std::size_t side, std::uint32_t node, const One& one, Counter& counter) const {
      return gap(one.volume, bodies_[side]->lanes(node, counter));
    }
    template <class Counter>
    Separated<S> separated(std::size_t side, std::uint32_t node, const One& one,
                           Counter& counter) const {
      return {gaps(side, node, one, counter), compared(side, node, one, counter).order};
    }
    const CornersBetween& corners() const { return corners_[0]; }
    Place place(std::size_t side, std::uint32_t node) const {
      return place_between(bodies_[side]->hierarchy().place(node), side, corners_);
    }

   private:
    std::array<Body<V, F>*, 2> bodies_;
    std::array<CornersBetween, 2> corners_;  // of a to b, and back
  };
};

using Frames = TypeList<RelativeFrame, WorldFrame>;

/// Puts a body where its pose says; `origin` is the same for all that are to be compared.
template <BoundingVolume V, int F>
void place(WideBody<V, F>& body, const Pose& pose, const Vec3<double>&) {
  body.stand(pose);
}
template <class Body>
requires requires(Body body, Pose pose, Vec3<double> origin) { body.place(pose, origin); }
void place(Body& body, const Pose& pose, const Vec3<double>& origin) { body.place(pose, origin); }

}  // namespace bvlab
