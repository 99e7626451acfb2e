// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/recorded.hpp"

#include <algorithm>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/trace.hpp"

namespace bvlab {

Array<double> Recorded::generate(std::span<const Extent>, const TouchesAny&) const {
  if (trace.empty()) throw Unusable("trace: names no file");
  const Trace all = read_trace(trace);
  const auto wanted = [&](const char* what, std::size_t asked, std::size_t held) {
    if (asked > held)
      throw Unusable(trace,
                     "has " + std::to_string(held) + " " + what + ", not " + std::to_string(asked));
    return asked == 0 ? held : asked;
  };
  const std::size_t length = wanted("frames", frames, all.frames);
  const std::size_t bodies = wanted("objects", objects, all.objects);
  Array<double> part{{length, bodies, 7}, {}};
  part.data.reserve(length * bodies * 7);
  for (std::size_t frame = 0; frame < length; ++frame) {
    const auto first = all.values.begin() + static_cast<std::ptrdiff_t>(frame * all.objects * 7);
    part.data.insert(part.data.end(), first, first + static_cast<std::ptrdiff_t>(bodies * 7));
  }
  return part;
}

}  // namespace bvlab
