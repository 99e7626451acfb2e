// SPDX-License-Identifier: BSD-3-Clause
/// A path planner at work: the talk's algorithm was part of one (li1998incremental). Bodies stand
/// about in a cube as a maze, and the last body looks for a way through them by a rapidly exploring
/// random tree (kuffner2000rrt). Every frame is one placement that the planner asks about.
///
/// - Obstacles stand anywhere in the cube, also through each other, but for its two ends: the robot
///   starts below the middle of the low side along x, and its goal is the same on the high side.
/// - The planner draws a placement (one time in ten the goal), takes the nearest one in its tree
///   (distance of the centres, plus the robot's radius times how far it has to turn), and goes from
///   there towards it in steps of at most `step` and `degrees`, as long as the robot touches
///   nothing. So frames come in runs of small steps, and runs start anywhere in the tree.
/// - At the goal it starts anew, with a fresh tree, from where it is to the other end.
#pragma once

#include "experiments/scenes/scene.hpp"

namespace bvlab {

struct Planner {
  static constexpr std::string_view name = "planner";
  static constexpr std::string_view description =
      "a rapidly exploring random tree finding its way through a maze of bodies";

  std::size_t objects = 9;
  std::size_t frames = 1000;
  Length side{6, Length::Unit::body};
  Length step{1, Length::Unit::leaf};
  double degrees = 5;
  std::uint64_t seed = 1;

  template <class Visit>
  void visit_options(Visit&& visit) {
    visit("objects", objects, "number of bodies, the robot included");
    visit("frames", frames, "number of configurations queried");
    visit("side", side, "side of the cube that the centres stay in");
    visit("step", step, "length of a step, at most");
    visit("degrees", degrees, "angle of a step, at most");
    visit("seed", seed, "of the random numbers");
  }

  /// Throws Unusable, naming the option, where values cannot be, whatever the meshes.
  void check() const;

  Array<double> generate(std::span<const Extent> meshes, const TouchesAny& touches) const;
};

static_assert(Scene<Planner>);

}  // namespace bvlab
