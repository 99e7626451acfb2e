// SPDX-License-Identifier: BSD-3-Clause
/// Somebody else's motion: the bodies and frames of a trace in a file, as they stand, or the first
/// ones. What a body's mesh is the trace does not say, so meshes are taken in the file's units (a
/// mesh by name is of any size: give it a scale).
#pragma once

#include "experiments/scenes/scene.hpp"

namespace bvlab {

struct Recorded {
  static constexpr std::string_view name = "recorded";
  static constexpr std::string_view description = "the motion in a file: first frames and bodies";

  std::string trace;
  std::size_t objects = 0;  ///< 0: as many as there are
  std::size_t frames = 0;

  template <class Visit>
  void visit_options(Visit&& visit) {
    visit("trace", trace, "file of a recorded motion, `.npy`, shape (frames, objects, 7), all of which is taken unless "
          "`objects` or `frames` is set");
    visit("objects", objects, "number of bodies; 0: all of the file");
    visit("frames", frames, "number of frames, the start included; 0: all of the file");
  }

  /// Throws Unusable, naming the option or the file, where it has not as many.
  Array<double> generate(std::span<const Extent> meshes, const TouchesAny& touches) const;
};

static_assert(Scene<Recorded>);

}  // namespace bvlab
