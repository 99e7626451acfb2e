// SPDX-License-Identifier: BSD-3-Clause
/// Boxes alone: which overlap, and what has begun and ended since the last frame? Told which boxes
/// moved, `blocks` looks at no others.
#include <cstdio>

#include "broadphase/methods/blocks.hpp"

using namespace bvlab;

int main() {
  // A row of unit boxes with gaps; closed boxes overlap where they touch.
  std::vector<Box<float>> boxes;
  for (int i = 0; i < 1000; ++i) boxes.push_back({{1.5f * i, 0, 0}, {1.5f * i + 1, 1, 1}});
  MethodSettings settings;
  settings.changes = Changes::reported;
  Blocks<float, Closed> method(settings);
  std::printf("%zu pairs at first\n", method.overlapping(boxes).size());

  for (int frame = 0; frame < 3; ++frame) {
    const std::uint32_t moved[] = {0};
    boxes[0].lo[0] += 1, boxes[0].hi[0] += 1;
    const std::size_t pairs = method.update(boxes, moved).size();
    std::printf("frame %d: %zu pairs,", frame, pairs);
    for (const auto& [i, j] : method.changes().began) std::printf(" began %u-%u", i, j);
    for (const auto& [i, j] : method.changes().ended) std::printf(" ended %u-%u", i, j);
    std::printf("\n");
  }
}
