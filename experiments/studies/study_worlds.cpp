// SPDX-License-Identifier: BSD-3-Clause
/// Whole scenes: many bodies in a closed cube of which some move, our engine and other libraries'
/// complete pipelines on the same trace, answers compared pair by pair in every frame.
#include <algorithm>
#include <cmath>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/world_peers.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/worlds.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/side_by_side.hpp"
#include "experiments/studies/study.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {
namespace {

struct Contestant {
  Variant variant;
  std::string configuration;  ///< that the variant has by name; or empty
  std::string peer;           ///< empty: ours
  int threads = 1;
};

/// What all contestants are given.
struct Scene {
  std::size_t objects;
  double room;  ///< side of the cube, in body radii, for as many bodies as the talk has
  double moving;
  double step, degrees;  ///< in body radii
};

struct Settings {
  std::string mesh;
  std::size_t polygons, frames;
  std::uint64_t seed;
  std::vector<Scene> scenes;
  std::vector<Contestant> contestants;
};

/// The talk's workspace holds nine; a larger one keeps the density.
double side_of(const Scene& scene) {
  return scene.room * std::cbrt(static_cast<double>(scene.objects) / 9);
}

StudyParameters parameters() {
  const Variant standard;
  return {one(words_parameter("mesh", {"bunny"}, "NAME")),
          one(wholes_parameter("polygons", {500}, {1, 1e7}, "triangles of the mesh")),
          one(wholes_parameter("frames", {12}, {2, 1e5}, "frames, the start included")),
          one(wholes_parameter("seed", {1}, {0, 1e9}, "of the random numbers")),
          numbers_parameter("steps", {0.03}, {0, 1e6}, "lengths of a step, in radii of the body"),
          numbers_parameter("degrees", {5}, {0, 180}, "angles of a step, one for each length"),
          wholes_parameter("objects", {1000}, {1, 1e6}, "bodies"),
          numbers_parameter("rooms", {4}, {1e-6, 1e6},
                            "sides of the cube for nine bodies, in radii of the body"),
          numbers_parameter("moving", {1, 0.1, 0.01}, {0, 1}, "parts of the bodies that move"),
          wholes_parameter("threads", {1}, {1, 1024}, "of ours"),
          words_parameter("volumes", {"sphere"}, "see `bvlab list volumes`"),
          words_parameter("strategies", {"recursive"}, "see `bvlab list strategies`"),
          one(words_parameter("build", {standard.build}, "see `bvlab list builds`")),
          one(words_parameter("fit", {standard.fit}, "how volumes are fitted")),
          one(wholes_parameter("leaf_size", {static_cast<double>(standard.leaf_size)}, {1, 64},
                               "triangles in a leaf, at most")),
          words_parameter("configurations", {}, "see `bvlab list configurations`"),
          words_parameter("peers", {}, "complete pipelines of others")};
}

Settings settings_of(const StudyDefinition& definition) {
  Settings settings{definition.word("mesh"),
                    definition.whole("polygons"),
                    definition.whole("frames"),
                    definition.whole("seed"),
                    {},
                    {}};
  const auto steps = definition.numbers("steps"), degrees = definition.numbers("degrees");
  if (steps.size() != degrees.size())
    throw Unusable(definition.file, "steps and degrees must have equally many values");
  for (const std::size_t objects : definition.wholes("objects"))
    for (const double room : definition.numbers("rooms"))
      for (const double moving : definition.numbers("moving"))
        for (std::size_t k = 0; k < steps.size(); ++k)
          settings.scenes.push_back({objects, room, moving, steps[k], degrees[k]});
  std::vector<int> threads;
  for (const std::size_t each : definition.wholes("threads")) {
    if (each > 1 && !Threads::available)
      throw Unusable(definition.file,
                     "threads: only 1 is available: TBB was not found when bvlab was built");
    threads.push_back(static_cast<int>(each));
  }
  for (const auto& volume : definition.words("volumes"))
    for (const auto& strategy : definition.words("strategies")) {
      Variant variant;
      variant.volume = volume, variant.strategy = strategy;
      variant.build = definition.word("build");
      variant.fit = definition.word("fit");
      variant.leaf_size = static_cast<std::uint32_t>(definition.whole("leaf_size"));
      check(variant);
      for (const int each : threads) settings.contestants.push_back({variant, "", "", each});
    }
  for (const auto& name : definition.words("configurations")) {
    const Variant variant = configured({}, name);
    for (const int each : threads) settings.contestants.push_back({variant, name, "", each});
  }
  for (const auto& peer : definition.words("peers")) {
    if (!is_world_peer(peer))
      throw Unusable(definition.file, "peers: no '" + peer + "'; available: " + world_peer_names());
    settings.contestants.push_back({{}, "", peer, 1});
  }
  return settings;
}

void check_settings(const StudyDefinition& definition) { settings_of(definition); }

Trace trace_of(const Scene& scene, const Settings& settings, const TriangleMesh& mesh) {
  RandomWalk walk;
  walk.objects = scene.objects;
  // With `moving` 0 nobody moves.
  const auto movers =
      static_cast<std::size_t>(std::lround(scene.moving * static_cast<double>(scene.objects)));
  walk.moving = std::max<std::size_t>(movers, 1);
  walk.frames = movers ? settings.frames : 1;
  walk.side = {side_of(scene), Length::Unit::body};
  walk.step = {scene.step, Length::Unit::body};
  walk.degrees = scene.degrees;
  walk.seed = settings.seed;
  const Extent extent = extent_of(mesh);
  auto array = walk.generate(std::span(&extent, 1), {});
  if (!movers) {
    const auto first = array.data;
    for (std::size_t frame = 1; frame < settings.frames; ++frame)
      array.data.insert(array.data.end(), first.begin(), first.end());
    array.shape[0] = settings.frames;
  }
  return {array.shape[0], array.shape[1], std::move(array.data)};
}

WorldRun run_of(const Contestant& who, const TriangleMesh& mesh, const Trace& trace,
                Answers answers) {
  const double start = wall_seconds();
  const std::span meshes(&mesh, 1);
  auto world = who.peer.empty() ? make_world(meshes, trace.objects, who.variant, who.threads)
                                : make_world_peer(who.peer, meshes, trace.objects);
  const double built = wall_seconds() - start;
  WorldRun run = play_frames(*world, trace, answers);
  run.build_seconds = built;
  return run;
}

void run(const StudyDefinition& definition, StudyRecord& record) {
  const Settings settings = settings_of(definition);
  for (const auto& who : settings.contestants)
    if (static_cast<std::size_t>(who.threads) > cores_allowed())
      throw Unusable(definition.file, "threads: " + std::to_string(who.threads) +
                                          " need as many processors; " +
                                          std::to_string(cores_allowed()) + " may be used");
  const TriangleMesh mesh = named_mesh(settings.mesh, settings.polygons).mesh;
  const auto key_of = [&](const Scene& scene) {
    Row row;
    add_to(row, scene.objects, scene.room, scene.moving, scene.step, scene.degrees, settings.mesh,
           settings.polygons, settings.frames, settings.seed);
    return row;
  };
  record.each(settings.scenes, key_of, [&](const Scene& scene) {
    const Trace trace = trace_of(scene, settings, mesh);
    const WorldRun reference = run_of({}, mesh, trace, Answers::kept);
    std::vector<std::size_t> differences;
    for (const auto& who : settings.contestants)
      differences.push_back(differing(run_of(who, mesh, trace, Answers::kept), reference));
    record.interleave(settings.contestants.size(), [&](std::size_t k, unsigned repetition) {
      const auto& who = settings.contestants[k];
      const WorldRun timed = run_of(who, mesh, trace, Answers::counted);
      const auto if_ours = [&](const auto& what) { return who.peer.empty() ? text_of(what) : ""; };
      record.add(if_ours(who.variant.volume), if_ours(who.variant.strategy),
                 if_ours(who.variant.kernel), who.configuration, who.peer, who.threads, repetition,
                 nanoseconds(timed.seconds), nanoseconds(timed.first_seconds),
                 nanoseconds(timed.build_seconds), timed.moved, if_ours(timed.near),
                 if_ours(timed.queried), timed.touching, differences[k]);
    });
  });
}

}  // namespace

const StudyKind studies::worlds = {
    "worlds",
    "whole scenes of many bodies, beside other libraries' complete pipelines",
    parameters,
    check_settings,
    {"objects",       "room",   "moving",  "step",       "degrees",  "mesh",
     "polygons",      "frames", "seed",    "volume",     "strategy", "kernel",
     "configuration", "peer",   "threads", "repetition", "time_ns",  "first_ns",
     "build_ns",      "moved",  "near",    "asked",      "touching", "differing"},
    run};

}  // namespace bvlab
