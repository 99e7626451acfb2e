// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/replay.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/strategy_text.hpp"
#include "experiments/replay/trials.hpp"
#include "experiments/replay/worlds.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/primitives/precisions.hpp"
#include "traversal/recommended_for.hpp"
#include "traversal/wide/kernels.hpp"

namespace bvlab {
namespace {

template <class List>
void check_name(std::string_view option, std::string_view name) {
  if (!List::with(name, [](auto) {}))
    throw Unusable(std::string(option) + " " + std::string(name) +
                   ": unknown; available: " + List::names());
}

constexpr std::uint32_t fan_outs[] = {2, 4, 8, 16};

void check_gathered(const Variant& variant) {
  const VolumeEntry& volume = volume_entry(variant.volume);
  play_entry(name_of(variant.strategy), variant.query).check(variant.strategy);
  if (frame_of(variant) == Frame::body && !volume.has_body_frame)
    throw Unusable("--frame body: not available for --volume " + variant.volume +
                   "; use --frame world");
}

void check_wide(const Variant& variant) {
  if (wide_fan_out(variant.volume, variant.kernel) == 0)
    throw Unusable("--volume " + variant.volume + ": the kernel " + variant.kernel +
                   " does not take it; there is " +
                   joined(wide_volumes(variant.kernel), &Named::name));
  if (!wide_entry(variant.volume, variant.query).pairs)
    throw Unusable("--query " + variant.query + ": not with --kernel " + variant.kernel +
                   ", which culls by whether volumes are disjoint; use --kernel gathered");
  play_entry(name_of(variant.strategy), variant.query).check(variant.strategy);
  if (!wide_strategy(name_of(variant.strategy)))
    throw Unusable("--strategy " + variant.strategy + ": not with --kernel " + variant.kernel +
                   "; there are those of strategies.hpp");
}

/// Names of a tree, a frame and a kernel, and what each kernel takes.
void check_engine(const Variant& variant) {
  if (std::find(std::begin(fan_outs), std::end(fan_outs), variant.fan_out) == std::end(fan_outs))
    throw Unusable("--fan-out " + std::to_string(variant.fan_out) +
                   ": unknown; available: 2, 4, 8, 16");
  if (variant.frame != name_of(Frame::world) && variant.frame != name_of(Frame::body))
    throw Unusable("--frame " + variant.frame + ": unknown; available: world, body");
  if (variant.kernel == "gathered")
    check_gathered(variant);
  else if (Kernels::with(variant.kernel, [](auto) {}))
    check_wide(variant);
  else
    throw Unusable("--kernel " + variant.kernel + ": unknown; available: gathered, " +
                   Kernels::names());
}

/// The pairs of a run of so many frames; 0: it is not known how many.
std::unique_ptr<PairsUnderSome> begun(const std::shared_ptr<PairsFrom>& from,
                                      const Variant& variant, std::size_t frames) {
  if (!variant.chooses_in_turn) return pairs_of(*from, variant);
  const std::vector<Recommendation> all = recommendations(variant, from->meshes);
  const auto triangles = static_cast<double>(triangles_of(from->meshes));
  std::vector<Trials::Candidate> candidates;
  std::vector<Variant> variants;
  for (const Recommendation& each : all) {
    candidates.push_back({each.name, each.build * triangles, PairsFrom::trees_of(each.variant),
                          each.in_frames * triangles});
    variants.push_back(each.variant);
  }
  return query_entry(variant.query)
      .in_turn(Trials(std::move(candidates), frames), from, std::move(variants));
}

}  // namespace

void set_kernel(Variant& variant, std::string_view kernel) {
  variant.kernel = kernel;
  const Variant gathered;
  variant.frame = gathered.frame, variant.fan_out = gathered.fan_out;
  for (const auto* entry : wide_entries())
    if (const std::uint32_t fan_out = entry->fan_out(kernel))
      variant.frame = name_of(Frame::body), variant.fan_out = fan_out;
}

bool set_tree(Variant& variant, std::string_view tree) {
  set_kernel(variant, tree == "wide" ? "siblings" : "gathered");
  return tree == "wide" || tree == "binary";
}

BroadPhase broad_phase_from(std::string_view name) {
  if (name == "auto") return BroadPhase::where_it_pays;
  if (name == "on") return BroadPhase::on;
  if (name == "off") return BroadPhase::off;
  throw Unusable("--broad-phase " + std::string(name) + ": unknown; available: auto, on, off");
}

void check(const Variant& variant) {
  check_engine(variant);
  check_name<Precisions>("--precision", variant.precision);
  check_name<Builds>("--build", variant.build);
  if (variant.fit != "published" && variant.fit != "tight")
    throw Unusable("--fit " + variant.fit + ": unknown; available: published, tight");
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
  return replay(
      std::make_shared<PairsFrom>(meshes, trace.objects, static_cast<int>(options.threads)), trace,
      variant, options);
}

ReplayResult replay(const std::shared_ptr<PairsFrom>& from, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options) {
  ReplayResult result;
  const double built = from->build_seconds();
  auto pairs = begun(from, variant, trace.frames);
  result.build_seconds = from->build_seconds() - built;
  const auto player = query_entry(variant.query)
                          .player(std::move(pairs), from->meshes, trace, variant, options, result);
  detail::play_frames(*player, trace, options, result);
  return result;
}

std::unique_ptr<WorldEngine> make_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant, int threads) {
  check(variant);
  const QueryEntry& query = query_entry(variant.query);
  if (!query.world)
    throw Unusable("--query " + variant.query + ": a whole scene takes only yes-or-no queries");
  const auto from = std::make_shared<PairsFrom>(meshes, objects, threads);
  return query.world(begun(from, variant, 0), variant, threads);
}

std::unique_ptr<PairsUnderSome> pairs_of(PairsFrom& from, const Variant& variant) {
  if (variant.kernel != "gathered")
    return wide_entry(variant.volume, variant.query).pairs(from, variant);
  return play_entry(name_of(variant.strategy), variant.query).pairs(from, variant);
}

bool detail::broad_phase_pays(const Trace& trace, const ReplayOptions& options) {
  return options.broad_phase == BroadPhase::where_it_pays && options.count == Count::off &&
         !options.keep_series && !options.see_front && has_many_pairs(trace);
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
    if (options.after_frame) options.after_frame(frame);
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
