// SPDX-License-Identifier: BSD-3-Clause
/// A pile: bodies dropped into a box, which bounce, roll, stack and come to rest. A simulation
/// recorded for its contacts and its rest; what becomes of each body follows from balls inside
/// them, not from the meshes.
///
/// - Bodies start in layers, `spread` of the largest body apart, above a floor of `side` by `side`
///   with walls, at any attitude, and fall. A body's ball has `core` times its radius: below 1 so
///   that the surfaces themselves meet where bodies lie on each other.
/// - Positions are corrected until balls neither meet each other nor leave the box, and velocities
///   follow from what was corrected (mueller2007position); a ball that slides is slowed and made to
///   roll.
/// - A body that has hardly moved for half a second stands still, to the last bit, until one that
///   moves touches it. Time steps are sixtieths of a second; gravity is 20 radii per second
///   squared.
#pragma once

#include "experiments/scenes/scene.hpp"

namespace bvlab {

struct Pile {
  static constexpr std::string_view name = "pile";
  static constexpr std::string_view description =
      "bodies dropped into a box: contact, stacking and rest";

  std::size_t objects = 9;
  std::size_t frames = 1000;
  Length side{6, Length::Unit::body};
  double core = 0.7;
  std::uint64_t seed = 1;

  template <class Visit>
  void visit_options(Visit&& visit) {
    visit("objects", objects, "number of bodies");
    visit("frames", frames, "number of frames, the start included");
    visit("side", side, "side of the floor");
    visit("core", core,
          "radius of the ball that stands for a body in collisions, in radii of the body");
    visit("seed", seed, "of the random numbers");
  }

  /// Throws Unusable, naming the option, where values cannot be, whatever the meshes.
  void check() const;

  Array<double> generate(std::span<const Extent> meshes, const TouchesAny& touches) const;
};

static_assert(Scene<Pile>);

}  // namespace bvlab
