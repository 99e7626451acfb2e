// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/replay_totals.hpp"

#include <algorithm>

#include "experiments/files/memory.hpp"
#include "experiments/replay/topology_of.hpp"
#include "experiments/replay/variant_parameters.hpp"

namespace bvlab {
namespace {

/// What there would have been to do: every pair to consider and every volume to pose in every
/// frame, and the tests of the recursive strategy. That is played once more for it, where counting
/// was asked for. In a body's frame a volume is posed for each test, so there is no such number.
void skipped(Totals& totals, const Variant& variant, const ReplayOptions& options,
             std::span<const TriangleMesh> meshes, const Trace& trace, const ReplayResult& result) {
  if (options.count != Count::on || frame_of(variant) == Frame::body) {
    totals.set("skipped", nullptr);
    return;
  }
  Variant from_roots = variant;
  from_roots.strategy = "recursive", from_roots.chooses_in_turn = false;
  ReplayOptions counted;
  counted.count = Count::on;
  counted.keep_answers = false;
  counted.after_frame = options.after_frame;
  const ReplayResult recursive =
      variant.strategy == "recursive" ? result : replay(meshes, trace, from_roots, counted);
  std::uint64_t volumes = 0;
  for (std::size_t m = 0; m < std::min(meshes.size(), trace.objects); ++m) {
    const std::size_t alike = (trace.objects - m - 1) / meshes.size() + 1;
    volumes += alike * nodes_of(meshes[m], from_roots);
  }
  Totals parts;
  const auto part = [&](const char* key, std::uint64_t done, std::uint64_t all) {
    Totals pair;
    pair.set("done", done).set("of", all);
    parts.set(key, pair);
  };
  part("pairs_considered", result.considered, trace.pairs() * trace.frames);
  part("volumes_posed", result.n_u, volumes * trace.frames);
  part("volume_tests", result.n_v, recursive.n_v);
  part("triangle_tests", result.n_p, recursive.n_p);
  totals.set("skipped", parts);
}

/// What every kind of replay begins its totals with.
template <class Result>
Totals times_of(const Trace& trace, const Result& result) {
  Totals totals;
  totals.set("seconds", result.seconds)
      .set("build_seconds", result.build_seconds)
      .set("first_seconds", result.first_seconds)
      .set("peak_bytes", peak_bytes())
      .set("frames", trace.frames)
      .set("objects", trace.objects)
      .set("pairs", trace.pairs());
  return totals;
}

void set_variant(Totals& totals, const Variant& variant) {
  visit_parameters(variant, [&](const char* name, const auto& value, std::string_view, SetBy) {
    totals.set(name, value);
  });
}

template <class Result>
void set_counts(Totals& totals, Count count, const Result& result) {
  const auto set = [&](const char* key, std::uint64_t value) {
    totals.set(key, count == Count::on ? std::optional(value) : std::nullopt);
  };
  if constexpr (requires { result.n_b; }) set("n_b", result.n_b);
  set("n_u", result.n_u), set("n_v", result.n_v), set("n_p", result.n_p);
}

}  // namespace

Totals totals_of(const ReplayResult& result, std::span<const TriangleMesh> meshes,
                 const Trace& trace, const Variant& variant, const ReplayOptions& options) {
  Totals totals = times_of(trace, result);
  totals.set(variant.query == "contacts" ? "contacts" : "touching", result.hits);
  set_counts(totals, options.count, result);
  totals.set("front", result.front);
  set_variant(totals, variant);
  if (variant.chooses_in_turn)
    totals.set("recommended", *result.chosen).set("choosing_seconds", result.choosing_seconds);
  totals.set("threads", options.threads)
      .set("broad_phase", result.near ? "on" : "off")
      .set("near", result.near);
  if (result.nodes > 0)
    totals.set("nodes_made", Totals().set("done", result.nodes_made).set("of", result.nodes));
  else
    totals.set("nodes_made", nullptr);
  skipped(totals, variant, options, meshes, trace, result);
  return totals;
}

Totals totals_of(const BudgetedResult& result, const Trace& trace, const Variant& variant,
                 std::uint64_t budget, Count count) {
  Totals totals = times_of(trace, result);
  totals.set("budget", budget)
      .set("touching", result.touching)
      .set("apart", result.apart)
      .set("unknown", result.unknown)
      .set("deepest", result.deepest)
      .set("mean_deepest", result.mean_deepest);
  set_counts(totals, count, result);
  set_variant(totals, variant);
  return totals;
}

}  // namespace bvlab
