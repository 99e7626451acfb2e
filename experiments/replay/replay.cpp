// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/replay.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay_budgeted.hpp"
#include "experiments/replay/strategy_text.hpp"
#include "experiments/replay/worlds.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

template <class List>
void check_name(std::string_view option, std::string_view name) {
  if (!List::with(name, [](auto) {}))
    throw Unusable(std::string(option) + " " + std::string(name) + ": unknown; there are " +
                   List::names());
}

/// Loops over binary trees know every strategy; those over wide ones two.
void check_tree(const Variant& variant) {
  if (variant.tree == "binary") {
    volume_entry(variant.volume);
    play_entry(name_of(variant.strategy), variant.query).check(variant.strategy);
  } else if (variant.tree == "wide") {
    wide_entry(variant.volume, variant.query);
    if (variant.strategy != "recursive" && variant.strategy != "margins")
      throw Unusable("--strategy " + variant.strategy +
                     ": not in wide trees; there are recursive, margins");
  } else {
    throw Unusable("--tree " + variant.tree + ": unknown; there are binary, wide");
  }
}

void need_binary(const Variant& variant, const char* what) {
  if (variant.tree != "binary")
    throw Unusable("--tree " + variant.tree + ": not for " + what + "; there is binary");
}

}  // namespace

void check(const Variant& variant) {
  check_tree(variant);
  check_name<Precisions>("--precision", variant.precision);
  check_name<Builds>("--build", variant.build);
  if (variant.fit != "published" && variant.fit != "tight")
    throw Unusable("--fit " + variant.fit + ": unknown; there are published, tight");
  if (variant.leaf_size < 1 || variant.leaf_size > 1u << 16)
    throw Unusable("--leaf-size " + std::to_string(variant.leaf_size) + ": must be 1 to 65536");
  if (!(variant.relative_error >= 0) || !std::isfinite(variant.relative_error))
    throw Unusable("--relative-error " + std::to_string(variant.relative_error) +
                   ": must be a number that is not negative");
}

ReplayResult replay(std::span<const TriangleMesh> meshes, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options) {
  check(variant);
  // Nothing happens without frames, so bodies are not made, however many there would be.
  if (trace.frames == 0 && trace.objects > 0) return replay(meshes, Trace{}, variant, options);
  ReplayResult result;
  if (variant.tree == "wide") {
    wide_entry(variant.volume, variant.query).play(meshes, trace, variant, options, result);
    return result;
  }
  const VolumeEntry& volume = volume_entry(variant.volume);
  const auto start = Clock::now();
  const auto hierarchies = volume.hierarchies(meshes, variant);
  result.build_seconds = seconds_since(start);
  play_entry(name_of(variant.strategy), variant.query)
      .play(volume, *hierarchies, trace, variant, options, result);
  return result;
}

BudgetedResult replay_budgeted(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, std::uint64_t budget, Count count) {
  check(variant);
  need_binary(variant, "answers within a budget");
  return volume_entry(variant.volume).budgeted(meshes, trace, variant, budget, count);
}

std::unique_ptr<WorldEngine> make_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant, int threads) {
  check(variant);
  std::unique_ptr<WorldEngine> world;
  if (variant.tree == "wide") {
    world = wide_entry(variant.volume, variant.query).world(meshes, objects, variant, threads);
  } else {
    const VolumeEntry& volume = volume_entry(variant.volume);
    world = play_entry(name_of(variant.strategy), variant.query)
                .world(volume, volume.hierarchies(meshes, variant), objects, variant, threads);
  }
  if (!world)
    throw Unusable("--query " + variant.query + ": whole scenes are asked yes or no alone");
  return world;
}

void detail::play_frames(Player& player, const Trace& trace, const ReplayOptions& options,
                         ReplayResult& result) {
  if (options.keep_frame_seconds) result.frame_seconds.reserve(trace.frames);
  const auto start = Clock::now();
  auto last = start;
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    player.play(frame);
    if (frame == 0) result.first_seconds = seconds_since(start);
    if (options.keep_frame_seconds) {
      const auto now = Clock::now();
      result.frame_seconds.push_back(std::chrono::duration<double>(now - last).count());
      last = now;
    }
  }
  result.seconds = seconds_since(start);
  player.finish();
  std::sort(result.contacts.begin(), result.contacts.end());
  const double asked = static_cast<double>(trace.pairs()) * static_cast<double>(trace.frames);
  result.front = asked > 0 ? result.front / asked : 0;
  // Counts have been running totals so far.
  for (std::size_t frame = result.series.size(); frame-- > 1;) {
    auto& now = result.series[frame];
    const auto& before = result.series[frame - 1];
    now.n_u -= before.n_u, now.n_v -= before.n_v, now.n_p -= before.n_p, now.hits -= before.hits;
  }
}

}  // namespace bvlab
