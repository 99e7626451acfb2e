// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/replay.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "experiments/files/unusable.hpp"
#include "experiments/runner/replay_shares.hpp"
#include "experiments/runner/strategy_text.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

static_assert(Volumes::size == BVLAB_VOLUMES, "volumes.hpp must hold one entry a line");

namespace {

template <class List>
void check_name(std::string_view option, std::string_view name) {
  if (!List::with(name, [](auto) {}))
    throw Unusable(std::string(option) + " " + std::string(name) + ": unknown; there are " +
                   List::names());
}

}  // namespace

void check(const Variant& variant) {
  check_name<Volumes>("--volume", variant.volume);
  check_name<Strategies>("--strategy", name_of(variant.strategy));
  check_name<Queries>("--query", variant.query);
  check_name<Precisions>("--precision", variant.precision);
  check_name<Builds>("--build", variant.build);
  if (variant.fit != "published" && variant.fit != "tight")
    throw Unusable("--fit " + variant.fit + ": unknown; there are published, tight");
  if (variant.leaf_size < 1 || variant.leaf_size > 1u << 16)
    throw Unusable("--leaf-size " + std::to_string(variant.leaf_size) + ": must be 1 to 65536");
  if (!(variant.relative_error >= 0) || !std::isfinite(variant.relative_error))
    throw Unusable("--relative-error " + std::to_string(variant.relative_error) +
                   ": must be a number that is not negative");
  Strategies::with(name_of(variant.strategy),
                   [&]<class S>(std::type_identity<S>) { made_from<S>(variant.strategy); });
}

ReplayResult replay(std::span<const TriangleMesh> meshes, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options) {
  check(variant);
  // Nothing happens without frames, so bodies are not made, however many there would be.
  if (trace.frames == 0 && trace.objects > 0) return replay(meshes, Trace{}, variant, options);
  ReplayResult result;
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    result = replay_with<V>(meshes, trace, variant, options);
  });
  return result;
}

void detail::play_shares(const Trace& trace, const ReplayOptions& options, const MakeShare& make,
                         ReplayResult& result) {
  if (options.keep_series) result.series.resize(trace.frames);
  const std::size_t pairs = trace.pairs();
  // A series is of all pairs together, so one thread plays it.
  const std::size_t threads =
      options.keep_series
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
