// SPDX-License-Identifier: BSD-3-Clause
/// A small scene played by the engine alone, for its instructions to be counted in `play`: bumpy
/// spheres that drift through each other. BVLAB_COUNTER and BVLAB_STRATEGY say how.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace {

using namespace bvlab;
using Volume = Volumes::at<0>;
using Engine = AllPairs<Batch<float, 4>, Volume, BVLAB_STRATEGY>;
constexpr std::uint32_t objects = 5, around = 24, along = 12;
constexpr int frames = 40;

TriangleMesh bumpy_sphere() {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double polar = std::numbers::pi * i / along, turn = 2 * std::numbers::pi * j / around;
      const double r = 1 + 0.2 * std::sin(5 * polar) * std::cos(3 * turn);
      mesh.vertices.push_back({r * std::sin(polar) * std::cos(turn),
                               r * std::sin(polar) * std::sin(turn), r * std::cos(polar)});
    }
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      mesh.triangles.push_back({a, a + around, b});
      mesh.triangles.push_back({b, a + around, b + around});
    }
  return mesh;
}

}  // namespace

/// All frames; what is found, so that nothing is left out.
extern "C" __attribute__((noinline)) std::uint64_t play(Engine& engine, BVLAB_COUNTER& counter) {
  std::vector<Pose> poses(objects);
  std::uint64_t hits = 0;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::uint32_t i = 0; i < objects; ++i) {
      const double t = 0.05 * frame + i;
      poses[i] = *pose_from({2.5 * std::sin(1.3 * t + i), 1.5 * std::cos(0.9 * t), std::sin(t * i)},
                            1, 0.3 * t, 0.2 * i, 0.1);
    }
    engine.frame(
        poses, counter, [](std::size_t) { return Touching(); },
        [&](std::size_t, const Touching& query) { hits += query.touching(); });
  }
  return hits;
}

int main() {
  const TriangleMesh mesh = bumpy_sphere();
  const Hierarchy<Volume> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  const std::vector<Shape<Volume>> shapes(objects, {&mesh, &hierarchy});
  Engine engine(shapes, all_object_pairs(objects), BVLAB_STRATEGY{});
  BVLAB_COUNTER counter;
  const std::uint64_t hits = play(engine, counter);
  std::printf("%llu touching, n_u %llu, n_v %llu, n_p %llu\n", (unsigned long long)hits,
              (unsigned long long)counter.n_u, (unsigned long long)counter.n_v,
              (unsigned long long)counter.n_p);
}
