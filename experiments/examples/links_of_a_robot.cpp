// SPDX-License-Identifier: BSD-3-Clause
/// Does an arm touch itself? Neighbouring links always meet where they are joined: these pairs are
/// left out.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ring.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/world.hpp"

using namespace bvlab;

constexpr std::uint32_t links = 6;

void print_touching(const char* what, const PairChoice& choice) {
  const TriangleMesh mesh = ring();
  const auto hierarchy = Recommended::hierarchy(mesh);
  const std::vector<Recommended::Shape> shapes(links, {&mesh, &hierarchy});
  World world(shapes);
  world.choose(choice);
  // Rings about a circle: each overlaps the next, and the last one the first.
  for (std::uint32_t i = 0; i < links; ++i) {
    const double angle = 2 * std::numbers::pi * i / links;
    world.move(i, pose_from({2.2 * std::cos(angle), 2.2 * std::sin(angle), 0}, 1, 0, 0, 0).value());
  }
  TouchingPairs touching;
  NotCounting counter;
  world.update(
      counter, [](const ObjectPair&) { return Touching(); },
      [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
        touching.put(slot, pair, query.touching());
      },
      [&](std::uint32_t slot) { touching.drop(slot); });
  std::vector<ObjectPair> pairs(touching.pairs().begin(), touching.pairs().end());
  std::sort(pairs.begin(), pairs.end(), [](const ObjectPair& a, const ObjectPair& b) {
    return a.i != b.i ? a.i < b.i : a.j < b.j;
  });
  std::printf("%s:", what);
  for (const auto& [i, j] : pairs) std::printf(" %u-%u", i, j);
  std::printf("\n");
}

// Without memory, the program ends. NOLINTNEXTLINE(bugprone-exception-escape)
int main() {
  print_touching("all pairs", {});
  PairChoice choice;
  for (std::uint32_t i = 0; i + 1 < links; ++i) choice.without.push_back({i, i + 1});
  print_touching("without neighbours", choice);
}
