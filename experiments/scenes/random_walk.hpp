// SPDX-License-Identifier: BSD-3-Clause
/// Bodies wandering about a closed cube: in every frame some of them make one step, of a fixed
/// length and a fixed angle. This is the talk's experiment [li1998incremental], whose "moving
/// randomly" leaves open all that is an option here.
///
/// - A body's centre (Extent::centre) stays in the cube, which is centred at the world's origin;
/// where
///   a step would lead out it is mirrored at the wall.
/// - `freedoms = all`: the step is a translation by `step` in any direction together with a turn by
///   `degrees` about any axis through the centre. `one`: one of these six, as likely as the others:
///   a translation by `step` along the world's x, y or z, either way, or a turn by `degrees` about
///   the world's x, y or z through the centre, either way.
/// - With probability `persistence` a body repeats its last step (as the walls mirrored it) instead
///   of drawing a new one.
/// - `contact = reject`: bodies start apart, and a step after which the body would touch another is
///   not made, and is forgotten. Bodies move one after the other, in the order of their numbers.
/// - A teleport puts one body, any, at any place and attitude; with `reject`, one where it touches
///   nothing, or it stays after 1000 tries.
/// - Frame 0 is the start. The same options and bodies give the same bytes on every machine.
#pragma once

#include "experiments/scenes/scene.hpp"

namespace bvlab {

struct RandomWalk {
  static constexpr std::string_view name = "random-walk";
  static constexpr std::string_view description =
      "bodies wandering about a closed cube, step by step";

  std::size_t objects = 9;
  std::size_t frames = 1000;
  Length side{6, Length::Unit::body};
  Length step{1, Length::Unit::leaf};
  double degrees = 5;
  std::size_t moving = 0;  ///< bodies that make a step in a frame, drawn anew each time; 0: all
  std::string freedoms = "all";
  double persistence = 0;
  std::string contact = "pass";
  double teleport = 0;
  std::uint64_t seed = 1;

  template <class Visit>
  void visit_options(Visit&& visit) {
    visit("objects", objects, "number of bodies");
    visit("frames", frames, "number of frames, the start included");
    visit("side", side, "side of the cube that the centres stay in");
    visit("step", step, "length of a step");
    visit("degrees", degrees, "angle of a step");
    visit("moving", moving, "how many bodies make a step in a frame; 0: all");
    visit("freedoms", freedoms, "what a step changes: one degree of freedom, or all [one|all]");
    visit("persistence", persistence, "probability that a body repeats its last step");
    visit("contact", contact, "whether a step into contact is made or undone [pass|reject]");
    visit("teleport", teleport, "probability, per frame, that one body is put somewhere else");
    visit("seed", seed, "of the random numbers");
  }

  /// Throws Unusable, naming the option, where values cannot be, whatever the meshes.
  void check() const;

  Array<double> generate(std::span<const Extent> meshes, const TouchesAny& touches) const;
};

static_assert(Scene<RandomWalk>);

}  // namespace bvlab
