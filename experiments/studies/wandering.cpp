// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/wandering.hpp"

#include "experiments/files/unusable.hpp"
#include "experiments/replay/touches_any.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/scenes.hpp"

namespace bvlab {

Wandering::Wandering(const StudyDefinition& definition)
    : names(definition.strings("mesh", {"bunny"})),
      polygons(definition.whole("polygons", 5000, most_polygons)),
      objects(definition.whole("objects", 9, 1000)),
      frames(definition.whole("frames", 50, 1'000'000)),
      seed(definition.whole("seed", 1, 1'000'000'000)),
      side(definition.number("side", 4)),
      step(definition.number("step", 0.1)),
      degrees(definition.number("degrees", 20)) {}

Wandering::Scene Wandering::scene(const std::string& name) const {
  Scene scene;
  auto named = named_meshes(name, polygons);
  if (named.size() != 1) throw Unusable(name + ": must be one mesh");
  scene.meshes.push_back(std::move(named[0].mesh));
  const Extent extents[] = {extent_of(scene.meshes[0])};
  scene.radius = extents[0].radius;
  RandomWalk walk;
  walk.objects = objects, walk.frames = frames, walk.seed = seed, walk.degrees = degrees;
  walk.side = {side, Length::Unit::body}, walk.step = {step, Length::Unit::body};
  walk.check();
  auto array = walk.generate(extents, {});
  scene.trace = {array.shape[0], array.shape[1], std::move(array.data)};
  return scene;
}

}  // namespace bvlab
