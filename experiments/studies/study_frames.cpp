// SPDX-License-Identifier: BSD-3-Clause
/// The frame of comparison: every volume in wide trees, tested in the world or in the other body's
/// frame. What is posed and tested (n_u, n_v, n_p), what that takes (pose_ns is C_u, test_ns C_v of
/// one lane, begin_ns what a pair needs before its first volume, timed apart, see frames_of.hpp)
/// and the time of all frames (time_ns). Touching, from the roots; bodies wander closer together or
/// farther apart (`sides`, in radii).
///
/// Answers are held against those of recursion over binary trees.
#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/studies/frames/frames_entry.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/wandering.hpp"

namespace bvlab {
namespace {

struct Settings {
  Wandering wandering;
  std::vector<double> sides, fan_outs;
  std::vector<std::string> volumes;
  Variant variant;

  explicit Settings(const StudyDefinition& definition)
      : wandering(definition),
        sides(definition.numbers("sides", {1, 4, 8})),
        fan_outs(definition.numbers("fan_outs", {8, 16})),
        volumes(definition.strings("volumes", all_volumes())) {
    variant.build = definition.strings("build", {"top-down-surface-area"})[0];
    variant.fit = definition.strings("fit", {"published"})[0];
    variant.leaf_size = static_cast<std::uint32_t>(definition.whole("leaf_size", 16, 1u << 16));
    bvlab::check(variant);
    if (definition.parameters.contains("side"))
      throw Unusable(definition.file, "there are several sides: sides = [...]");
    for (const double side : sides)
      if (!(side > 0 && side <= 1e6))
        throw Unusable(definition.file, "sides must be from 0 to 1e6");
    for (const double fan_out : fan_outs)
      if (fan_out != 2 && fan_out != 4 && fan_out != 8 && fan_out != 16)
        throw Unusable(definition.file, "fan_outs must be of 2, 4, 8, 16");
    const auto known = all_volumes();
    for (const auto& volume : volumes)
      if (std::find(known.begin(), known.end(), volume) == known.end()) volume_entry(volume);
  }

 private:
  static std::vector<std::string> all_volumes() {
    std::vector<std::string> names;
    for (const auto& list : {bvlab::volumes(), wide_volumes()})
      for (const auto& volume : list) names.push_back(volume.name);
    return names;
  }
};

struct Cell {
  const FramesEntry* entry;
  ReplayResult counted;
};

std::vector<Cell> cells_of(const StudyDefinition& definition, const Settings& settings) {
  if (frames_entries().empty())
    throw Unusable(definition.file,
                   "volumes in every frame are not in this program: build bvlab_frames "
                   "(ninja -C build/release bvlab_frames) and run the definition by that");
  std::vector<Cell> cells;
  for (const auto& volume : settings.volumes) {
    const auto before = cells.size();
    for (const auto* entry : frames_entries())
      if (entry->volume == volume && std::count(settings.fan_outs.begin(), settings.fan_outs.end(),
                                                static_cast<double>(entry->fan_out)))
        cells.push_back({entry, {}});
    if (cells.size() == before)
      throw Unusable(definition.file, volume + ": not compiled in any frame of these fan-outs");
  }
  return cells;
}

/// Runs take milliseconds, which one interruption doubles.
ReplayResult fastest_of_three(const FramesEntry& entry, const Wandering::Scene& scene,
                              const Variant& variant) {
  ReplayResult fastest = entry.replay(scene.meshes, scene.trace, variant, {});
  for (int again = 0; again < 2; ++again)
    if (auto other = entry.replay(scene.meshes, scene.trace, variant, {});
        other.seconds < fastest.seconds)
      fastest = std::move(other);
  return fastest;
}

void measure(const Wandering::Scene& scene, const Row& key, const Settings& settings,
             std::vector<Cell> cells, unsigned repetitions, std::mt19937_64& random,
             StudyRecord& record) {
  Variant reference;
  reference.volume = "obb";
  const auto truth = replay(scene.meshes, scene.trace, reference, {}).touching;
  ReplayOptions counting;
  counting.count = Count::on;
  for (auto& cell : cells)
    cell.counted = cell.entry->replay(scene.meshes, scene.trace, settings.variant, counting);
  for (unsigned repetition = 0; repetition < repetitions; ++repetition) {
    std::shuffle(cells.begin(), cells.end(), random);
    for (const auto& [entry, counted] : cells) {
      const auto timed = fastest_of_three(*entry, scene, settings.variant);
      const FrameCosts costs = entry->costs(scene.meshes, scene.trace, settings.variant);
      std::size_t differing = 0;
      for (std::size_t i = 0; i < truth.size(); ++i)
        differing += timed.touching[i] != truth[i] || counted.touching[i] != truth[i];
      Row row = key;
      row.insert(row.end(), {std::string(entry->volume), std::string(entry->frame)});
      for (const std::uint64_t n :
           {std::uint64_t(entry->fan_out), std::uint64_t{repetition}, std::uint64_t{truth.size()},
            timed.hits, std::uint64_t{differing}, counted.n_u, counted.n_v, counted.n_p})
        row.push_back(std::to_string(n));
      for (const double ns : {costs.begin, costs.pose, costs.test, std::round(timed.seconds * 1e9)})
        row.push_back(text_of(ns));
      record.add(std::move(row));
    }
  }
}

void check_settings(const StudyDefinition& definition) { Settings{definition}; }

void run(const StudyDefinition& definition, const std::filesystem::path& folder,
         const Progress& progress) {
  Settings settings(definition);
  const auto cells = cells_of(definition, settings);
  StudyRecord record(
      definition, folder,
      {"mesh", "side", "volume", "frame", "fan_out", "repetition", "pairs", "touching", "differing",
       "n_u", "n_v", "n_p", "begin_ns", "pose_ns", "test_ns", "time_ns"},
      2, progress);
  std::mt19937_64 random(20260101);
  const std::size_t all = settings.wandering.names.size() * settings.sides.size();
  std::size_t done = 0;
  for (const auto& name : settings.wandering.names)
    for (const double side : settings.sides) {
      settings.wandering.side = side;
      const Row key{name, text_of(side)};
      if (!record.has(key))
        measure(settings.wandering.scene(name), key, settings, cells, definition.repetitions,
                random, record);
      record.save(++done, all);
    }
}

}  // namespace

const StudyKind studies::frames = {
    "frames", "every volume in wide trees, tested in the world or in the other body's frame",
    check_settings, run};

}  // namespace bvlab
