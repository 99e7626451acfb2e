// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay_budgeted.hpp"
#include "experiments/replay/replay_shares.hpp"
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

std::vector<ObjectPair> detail::share_of_pairs(std::size_t objects, std::size_t first,
                                               std::size_t stride) {
  const auto all = all_object_pairs(static_cast<std::uint32_t>(objects));
  std::vector<ObjectPair> share;
  for (std::size_t p = first; p < all.size(); p += stride) share.push_back(all[p]);
  return share;
}

void detail::play_shares(const Trace& trace, const ReplayOptions& options, const MakeShare& make,
                         ReplayResult& result) {
  if (options.keep_series) result.series.resize(trace.frames);
  const std::size_t pairs = trace.pairs();
  // A series is of all pairs together, and fronts are shown in order, so one thread plays it.
  const std::size_t threads =
      options.keep_series || options.see_front
          ? 1
          : std::clamp<std::size_t>(options.threads, 1, std::max<std::size_t>(pairs, 1));
  std::vector<std::unique_ptr<Share>> shares;
  for (std::size_t t = 0; t < threads; ++t) shares.push_back(make(t, threads, result));
  const auto start = Clock::now();
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < threads; ++t)
      helpers.emplace_back([&share = *shares[t]] { share.play(); });
    shares[0]->play();
  }
  result.seconds = seconds_since(start);
  for (auto& share : shares) share->hand_over(result);
  std::sort(result.contacts.begin(), result.contacts.end());
  const double asked = static_cast<double>(pairs) * static_cast<double>(trace.frames);
  result.front = asked > 0 ? result.front / asked : 0;
  // Counts have been running totals so far.
  for (std::size_t frame = result.series.size(); frame-- > 1;) {
    auto& now = result.series[frame];
    const auto& before = result.series[frame - 1];
    now.n_u -= before.n_u, now.n_v -= before.n_v, now.n_p -= before.n_p, now.hits -= before.hits;
  }
}

}  // namespace bvlab
