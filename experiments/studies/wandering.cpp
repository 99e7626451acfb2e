// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/wandering.hpp"

#include "experiments/files/unusable.hpp"
#include "experiments/replay/touches_any.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/scenes.hpp"

namespace bvlab {

StudyParameters with_wandering(StudyParameters others) {
  for (auto& each :
       {words_parameter("mesh", {"bunny"}, "meshes, NAME or NAME:POLYGONS: a scene for each"),
        whole_parameter("polygons", 5000, {1, most_polygons}, "triangles of each mesh"),
        whole_parameter("objects", 9, {1, 1000}, "bodies"),
        whole_parameter("frames", 50, {1, 1e6}, "frames, the start included"),
        whole_parameter("seed", 1, seeds, "of the random numbers"),
        number_parameter("step", 0.1, lengths, "length of a step, in radii of the body"),
        number_parameter("degrees", 20, {0, 180}, "angle of a step")})
    others.push_back(each);
  return others;
}

StudyParameters with_wandering_and_side(StudyParameters others) {
  others.push_back(
      number_parameter("side", 4, sides_of_cubes, "of the cube, in radii of the body"));
  return with_wandering(std::move(others));
}

Wandering::Wandering(const StudyDefinition& definition, double side_of_cube)
    : names(definition.words("mesh")),
      polygons(definition.whole("polygons")),
      objects(definition.whole("objects")),
      frames(definition.whole("frames")),
      seed(definition.whole("seed")),
      side(side_of_cube),
      step(definition.number("step")),
      degrees(definition.number("degrees")) {}

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
