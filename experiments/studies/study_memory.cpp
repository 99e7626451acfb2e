// SPDX-License-Identifier: BSD-3-Clause
/// What a whole scene holds of the heap: measured, after the last of some frames in which all
/// bodies move. `shared_bytes` is the same for one body alone: hierarchies and whatever else
/// bodies of one mesh have in common. Of two rows that differ by the strategy alone, what one holds
/// more is what it remembers of pairs; `near` are the pairs whose boxes meet.
///
/// Variants are "tree volume strategy"; build, fit and leaf_size are those of binary trees, wide
/// ones are built as `recommended` has them.
#include <cmath>
#include <sstream>

#include "experiments/files/heap_bytes.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/worlds.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

StudyParameters parameters() {
  return {words_parameter("mesh", {"bunny:500"}, "meshes, NAME:POLYGONS: a scene for each"),
          whole_parameter("objects", 10000, {1, 1e6}, "bodies"),
          whole_parameter("frames", 10, {1, 1e5}, "frames, the start included"),
          whole_parameter("seed", 1, seeds, "of the random numbers"),
          number_parameter("step", 0.03, {0, 1e6}, "length of a step, in radii of the body"),
          number_parameter("degrees", 5, {0, 180}, "angle of a step"),
          numbers_parameter("rooms", {4}, {1e-6, 1e6},
                            "sides of the cube for nine bodies, in radii of the body"),
          word_parameter("build", "bottom-up", "of binary trees; see `bvlab list builds`"),
          word_parameter("fit", "tight", "of binary trees"),
          whole_parameter("leaf_size", 2, {1, 1 << 16}, "of binary trees"),
          words_parameter("variants", {"binary obb recursive"}, "\"tree volume strategy\" each")};
}

struct Settings {
  std::vector<std::string> meshes;
  std::size_t objects, frames, seed;
  double step, degrees;
  std::vector<double> rooms;
  std::vector<Variant> variants;

  explicit Settings(const StudyDefinition& definition)
      : meshes(definition.words("mesh")),
        objects(definition.whole("objects")),
        frames(definition.whole("frames")),
        seed(definition.whole("seed")),
        step(definition.number("step")),
        degrees(definition.number("degrees")),
        rooms(definition.numbers("rooms")) {
    const std::string build = definition.word("build"), fit = definition.word("fit");
    const auto leaf_size = static_cast<std::uint32_t>(definition.whole("leaf_size"));
    for (const auto& text : definition.words("variants")) {
      std::istringstream words(text);
      std::string tree, volume, strategy, more;
      if (!(words >> tree >> volume >> strategy) || words >> more)
        throw Unusable(definition.file, "variants: '" + text + "' is not \"tree volume strategy\"");
      Variant variant = configured({}, "recommended");
      if (tree != "wide") variant.build = build, variant.fit = fit, variant.leaf_size = leaf_size;
      if (!set_tree(variant, tree))
        throw Unusable(definition.file, "variants: tree '" + tree + "' is not binary or wide");
      variant.volume = volume, variant.strategy = strategy;
      bvlab::check(variant);
      variants.push_back(variant);
    }
  }
};

Trace trace_of(const Settings& settings, double room, const TriangleMesh& mesh) {
  RandomWalk walk;
  walk.objects = settings.objects, walk.frames = settings.frames, walk.seed = settings.seed;
  // The talk's workspace holds nine; a larger one keeps the density.
  walk.side = {room * std::cbrt(static_cast<double>(settings.objects) / 9), Length::Unit::body};
  walk.step = {settings.step, Length::Unit::body}, walk.degrees = settings.degrees;
  walk.check();
  const Extent extent = extent_of(mesh);
  auto array = walk.generate(std::span(&extent, 1), {});
  return {array.shape[0], array.shape[1], std::move(array.data)};
}

struct Held {
  std::size_t bytes = 0, near = 0, touching = 0;
};

/// By a scene of the first `objects` bodies of the trace, after its last frame.
Held held(const TriangleMesh& mesh, const Trace& trace, std::size_t objects,
          const Variant& variant) {
  std::vector<Pose> poses(trace.objects);
  const std::size_t before = heap_bytes();
  Held held;
  const auto world = make_world(std::span(&mesh, 1), objects, variant);
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    for (std::size_t i = 0; i < objects; ++i) world->move(static_cast<std::uint32_t>(i), poses[i]);
    world->update();
  }
  held.near = world->near(), held.touching = world->touching().size();
  held.bytes = heap_bytes() - before;
  return held;
}

void check_settings(const StudyDefinition& definition) { Settings{definition}; }

void run(const StudyDefinition& definition, const std::filesystem::path& folder,
         const Progress& progress) {
  const Settings settings(definition);
  StudyRecord record(definition, folder,
                     {"mesh", "objects", "room", "tree", "volume", "strategy", "repetition",
                      "frames", "near", "touching", "shared_bytes", "bytes"},
                     3, progress);
  std::size_t done = 0;
  for (const auto& name : settings.meshes) {
    const auto meshes = named_meshes(name, 500);
    if (meshes.size() != 1) throw Unusable(definition.file, name + ": must be one mesh");
    const TriangleMesh& mesh = meshes[0].mesh;
    for (const double room : settings.rooms) {
      const Row key{name, std::to_string(settings.objects), text_of(room)};
      if (!record.has(key)) {
        const Trace trace = trace_of(settings, room, mesh);
        for (const auto& variant : settings.variants) {
          const Held alone = held(mesh, trace, 1, variant);
          const Held all = held(mesh, trace, settings.objects, variant);
          Row row = key;
          row.insert(row.end(), {variant.kernel == "siblings" ? "wide" : "binary", variant.volume,
                                 variant.strategy, "0"});
          for (const std::size_t n : {trace.frames, all.near, all.touching, alone.bytes, all.bytes})
            row.push_back(std::to_string(n));
          record.add(std::move(row));
        }
      }
      record.save(++done, settings.meshes.size() * settings.rooms.size());
    }
  }
}

}  // namespace

const StudyKind studies::memory = {"memory",
                                   "what a whole scene holds of the heap, a body and a pair",
                                   parameters, check_settings, run};

}  // namespace bvlab
