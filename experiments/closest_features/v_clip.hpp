// SPDX-License-Identifier: BSD-3-Clause
/// V-Clip (mirtich1998vclip): a walk from one pair of features (vertex, edge or face of each
/// polytope) to the next that is nearer, until each lies in the Voronoi region of the other; it
/// starts where the last question ended, so that coherent questions take a step or two.
///
/// Each step either ends the walk or moves to a pair that is nearer, or as near and of lower
/// dimension: without rounding it ends. With rounding, regions of coplanar triangles can send it
/// round in circles, and where faces are parallel it can stop too early. So the end is checked:
/// nothing next to the nearest points may lie nearer along their line, which for convex bodies
/// means that nothing does. Where it fails, or after as many steps as there are features, a Gjk
/// from scratch answers (`gave_up` counts that).
#pragma once

#include <optional>

#include "experiments/closest_features/gjk.hpp"

namespace bvlab::closest_features {

class VClip {
 public:
  Witness nearest(const PosedPair& posed, Effort& effort);
  std::uint64_t gave_up() const { return gave_up_; }

 private:
  enum class Kind { vertex, edge, face };
  struct Feature {
    Kind kind = Kind::vertex;
    std::uint32_t index = 0;
  };
  enum class Step { moved, nearest, touching };

  /// An edge of one polytope in the frame of the other, cut down to where it is in a region; `by`
  /// are the features at whose planes it was cut.
  struct Clipped {
    Vec3<double> from, to;
    double low = 0, high = 1;
    std::optional<Feature> by_low, by_high;
    bool excluded = false;  ///< one plane alone leaves nothing
    Feature excluding;

    Vec3<double> at(double s) const { return from + s * (to - from); }
    bool empty() const { return excluded || low > high; }
    /// Keeps what is not below the plane whose signed distances at the two ends are given.
    void cut(double at_from, double at_to, Feature neighbour);
  };

  const Polytope& of(int side) const { return posed_->polytope(side); }
  Clipped edge_across(int side) const;
  Step step();
  Step vertex_vertex();
  Step vertex_edge(int side);
  Step edge_edge();
  Step vertex_face(int side);
  Step edge_face(int side);
  Step local_minimum(int side, const Vec3<double>& x);
  bool leaves_vertex(int side);
  bool leaves_edge(int side, const Vec3<double>& x);
  template <class Slope>
  bool follow(int side, const Clipped& clipped, const Slope& slope);
  Witness witness(Step last) const;
  /// Whether a face at the vertex looks in this direction (of the world).
  bool any_face_sees(int side, std::uint32_t vertex, const Vec3<double>& towards) const;
  bool certain(const Witness& witness) const;

  const PosedPair* posed_ = nullptr;
  Effort* effort_ = nullptr;
  std::array<Feature, 2> features_;
  std::uint64_t gave_up_ = 0;
};

}  // namespace bvlab::closest_features
