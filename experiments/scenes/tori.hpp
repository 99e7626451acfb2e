// SPDX-License-Identifier: BSD-3-Clause
/// A ring lies still while a smaller torus falls through its hole, tumbling: two curved surfaces
/// close to each other for most of the way, as in the falling torus that PQP came with
/// (larsen2000fast), whose path is not ours.
///
/// - Body 0 stays at the origin, as its mesh is. Body 1 falls along z from `fall` above to `fall`
///   below, at even speed; its centre wanders off the axis by up to `wobble` while it turns about x
///   and y, `turns` times about x and half as often about y.
/// - The same options and bodies give the same bytes on every machine.
#pragma once

#include "experiments/scenes/scene.hpp"

namespace bvlab {

struct Tori {
  static constexpr std::string_view name = "tori";
  static constexpr std::string_view description = "a torus tumbling through the hole of a ring";
  /// The ring's hole has radius 0.7.
  static constexpr std::string_view meshes = "ring:3200,torus:1300:0.66";
  static constexpr std::size_t objects = 2;

  std::size_t frames = 2000;
  double turns = 6;
  Length fall{0.3, Length::Unit::body};
  Length wobble{0.1, Length::Unit::body};

  template <class Visit>
  void visit_options(Visit&& visit) {
    visit("frames", frames, "number of frames");
    visit("turns", turns, "how often the torus turns over");
    visit("fall", fall, "height from which, and depth to which, it falls");
    visit("wobble", wobble, "how far its centre wanders off the axis");
  }

  /// Throws Unusable, naming the option, where values cannot be, whatever the meshes.
  void check() const;

  Array<double> generate(std::span<const Extent> meshes, const TouchesAny& touches) const;
};

static_assert(Scene<Tori>);

}  // namespace bvlab
