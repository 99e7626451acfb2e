// SPDX-License-Identifier: BSD-3-Clause
/// Many bodies, of which few move: which touch? Pairs of which no body has moved are not queried.
/// Bodies come, and leave.
#include <algorithm>
#include <cstdio>
#include <tuple>
#include <vector>

#include "ring.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/world.hpp"

using namespace bvlab;

int main() {
  const TriangleMesh mesh = ring();
  const auto hierarchy = Recommended::hierarchy(mesh);
  constexpr std::uint32_t bodies = 200;
  const std::vector<Recommended::Shape> shapes(bodies, {&mesh, &hierarchy});
  World world(shapes);
  // A row of rings that do not touch. What was never moved is not in the scene.
  for (std::uint32_t i = 0; i < bodies; ++i)
    world.move(i, pose_from({3.0 * i, 0, 0}, 1, 0, 0, 0).value());

  TouchingPairs touching;
  NotCounting counter;
  const auto update = [&](int frame) {
    int queried = 0;
    world.update(
        counter, [](const ObjectPair&) { return Touching(); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
          touching.put(slot, pair, query.touching()), ++queried;
        },
        [&](std::uint32_t slot) { touching.drop(slot); });
    std::printf("frame %d, %d pairs queried:", frame, queried);
    std::vector<ObjectPair> pairs(touching.pairs().begin(), touching.pairs().end());
    std::sort(pairs.begin(), pairs.end(), [](const ObjectPair& a, const ObjectPair& b) {
      return std::tie(a.i, a.j) < std::tie(b.i, b.j);
    });
    for (const auto& [i, j] : pairs) std::printf(" %u-%u", i, j);
    std::printf("\n");
  };
  for (int frame = 0; frame < 3; ++frame) {
    // Body 0 goes along the row, into one after the other.
    world.move(0, pose_from({3.0 * frame + 1, 0, 0}, 1, 0, 0, 0).value());
    update(frame);
  }
  // A ring comes, and has the next number; body 0 leaves.
  world.add(shapes[0], pose_from({3.0 * 150 + 1, 0, 0}, 1, 0, 0, 0).value());
  update(3);
  world.remove(0);
  update(4);
}
