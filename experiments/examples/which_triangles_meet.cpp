// SPDX-License-Identifier: BSD-3-Clause
/// Many bodies, of which few move: which triangles meet? Pairs of which no body has moved keep
/// their contacts.
#include <cstdio>

#include "ring.hpp"
#include "traversal/counters.hpp"
#include "traversal/world.hpp"

using namespace bvlab;

// Without memory, the program ends. NOLINTNEXTLINE(bugprone-exception-escape)
int main() {
  const TriangleMesh mesh = ring();
  const auto hierarchy = Recommended::hierarchy(mesh);
  constexpr std::uint32_t bodies = 200;
  const std::vector<Recommended::Shape> shapes(bodies, {&mesh, &hierarchy});
  World world(shapes);
  // A row of rings; bodies 100 and 101 touch.
  for (std::uint32_t i = 0; i < bodies; ++i)
    world.move(i,
               pose_from({i == 101 ? 302.03 : 3.0 * i, 0.02 * (i % 3), 0.01}, 1, 0, 0, 0).value());

  WorldContacts contacts;
  NotCounting counter;
  for (int frame = 0; frame < 3; ++frame) {
    world.move(0, pose_from({3.0 * frame + 1.01, 0.05, 0}, 1, 0, 0, 0).value());
    world.update(
        counter,
        [&](const ObjectPair& pair, std::uint32_t slot) { return contacts.query(pair, slot); },
        [](std::uint32_t, const ObjectPair&, const Contacts&) {},
        [&](std::uint32_t slot) { contacts.drop(slot); });
    std::printf("frame %d:", frame);
    contacts.for_each([](const ObjectPair& pair, std::span<const Contact> triangles) {
      std::printf(" %u-%u in %zu pairs of triangles", pair.i, pair.j, triangles.size());
    });
    std::printf("\n");
  }
}
