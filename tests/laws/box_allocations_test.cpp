// SPDX-License-Identifier: BSD-3-Clause
/// Once frames stop growing, no method allocates.
#include <gtest/gtest.h>

#include <atomic>

#include "experiments/replay/box_methods.hpp"
#include "tests/laws/boxes_for_test.hpp"
#include "tests/replaced_new.hpp"

namespace bvlab {
namespace {

std::atomic<std::size_t> allocations = 0;
[[maybe_unused]] const auto hook = before_allocation = [] { ++allocations; };

TEST(Allocations, NoneInSteadyState) {
  BoxMaker<float> random(6);
  const Frame<float> base = random.boxes(1500, 0, 1, 0.02f, 0.08f);
  Frame<float> boxes = base;
  const auto at = [&](int frame) {
    const float by = 0.002f * static_cast<float>(std::abs(frame % 8 - 4));
    for (std::size_t k = 0; k < boxes.size(); ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const float mine = k % 3 == static_cast<std::size_t>(axis) ? by : -by;
        boxes[k].lo[axis] = base[k].lo[axis] + mine;
        boxes[k].hi[axis] = base[k].hi[axis] + mine;
      }
  };
  for (const Coherence coherence : {Coherence::off, Coherence::on})
    for (const auto* entry : method_entries()) {
      MethodSettings settings;
      settings.coherence = coherence;
      const auto method = entry->narrow(settings);
      for (int frame = 0; frame < 48; ++frame) at(frame), method->overlapping(boxes);
      const std::size_t before = allocations;
      std::size_t found = 0;
      for (int frame = 48; frame < 64; ++frame)
        at(frame), found += method->overlapping(boxes).size();
      EXPECT_EQ(allocations - before, 0u)
          << entry->name << (coherence == Coherence::on ? ", coherent" : "");
      EXPECT_GT(found, 0u);
    }
}

}  // namespace
}  // namespace bvlab
