// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/recorded.hpp"

#include <algorithm>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/trace.hpp"

namespace bvlab {

Array<double> Recorded::generate(std::span<const Extent>, const TouchesAny&) const {
  if (trace.empty()) throw Unusable("trace: names no file");
  const Trace all = read_trace(trace);
  const auto enough = [&](const char* what, std::size_t asked, std::size_t held) {
    if (asked > held)
      throw Unusable(trace,
                     "has " + std::to_string(held) + " " + what + ", not " + std::to_string(asked));
  };
  enough("frames", frames, all.frames);
  enough("objects", objects, all.objects);
  Array<double> part{{frames, objects, 7}, {}};
  part.data.reserve(frames * objects * 7);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto first = all.values.begin() + static_cast<std::ptrdiff_t>(frame * all.objects * 7);
    part.data.insert(part.data.end(), first, first + static_cast<std::ptrdiff_t>(objects * 7));
  }
  return part;
}

}  // namespace bvlab
