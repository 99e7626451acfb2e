// SPDX-License-Identifier: BSD-3-Clause
/// Traces that strategies are tried on.
#pragma once

#include <utility>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"

namespace bvlab {

struct Setting {
  const char* name;
  std::vector<std::pair<const char*, std::size_t>> meshes;
  RandomWalk walk;
};

inline RandomWalk walk(std::size_t objects, std::size_t frames, double side, double step,
                       double degrees, double teleport, std::size_t moving = 0) {
  RandomWalk walk;
  walk.objects = objects;
  walk.frames = frames;
  walk.side = {side, Length::Unit::body};
  walk.step = {step, Length::Unit::body};
  walk.degrees = degrees;
  walk.teleport = teleport;
  walk.moving = moving;
  walk.seed = objects + frames;
  return walk;
}

/// Dense and sparse, slow and violent, one mover and all, with teleports between frames.
inline std::vector<Setting> settings(std::size_t frames) {
  return {
      {"dense", {{"star", 60}, {"torus", 64}}, walk(5, frames, 2, 0.05, 5, 0)},
      {"sparse", {{"bumpy-sphere", 80}}, walk(5, frames, 5, 0.05, 5, 0)},
      {"slow", {{"torus", 64}, {"knot", 96}}, walk(4, frames, 2, 0.001, 0.1, 0.002)},
      {"violent", {{"star", 60}, {"box", 12}}, walk(4, frames, 3, 0.5, 45, 0.1)},
      {"one mover", {{"icosphere", 80}, {"knot", 96}}, walk(6, frames, 3, 0.03, 5, 0.01, 1)},
  };
}

struct Played {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};

inline Played played(const Setting& setting) {
  Played result;
  std::vector<Extent> extents;
  for (const auto& [name, polygons] : setting.meshes) {
    result.meshes.push_back(formula_mesh(name, polygons));
    extents.push_back(extent_of(result.meshes.back()));
  }
  auto array = setting.walk.generate(extents, {});
  result.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  return result;
}

}  // namespace bvlab
