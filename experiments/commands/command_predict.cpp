// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab predict`: what each strategy would cost on a trace.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/variant_options.hpp"
#include "experiments/files/joined.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/coherence.hpp"
#include "experiments/replay/predict.hpp"
#include "experiments/replay/registry.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string trace, json, csv;
  Variant variant;
  std::optional<std::size_t> stride, window;
  double scale = 1;
};

using Rows = std::vector<Predicted>;

/// By `format`, of the strategy, n_v, n_p, seconds and their interval.
std::string lines(const Rows& rows, const char* format) {
  std::string text;
  for (const Predicted& row : rows) {
    char line[200];
    std::snprintf(line, sizeof line, format, std::string(row.strategy).c_str(), row.n_v, row.n_p,
                  row.seconds, row.low, row.high);
    text += line;
  }
  return text;
}

/// "deferred", or why nobody is named.
std::string verdict(const Rows& rows, const Trace& trace) {
  if (const auto why = nothing_to_tell(trace); !why.empty()) return "unknown: " + std::string(why);
  if (!can_tell(rows))
    return "unknown: " + std::to_string(rows.back().windows) + " of the " +
           std::to_string(least_windows) +
           " windows that are needed; a smaller --stride gives more";
  const auto names = candidates(rows);
  std::string text(names[0]);
  for (std::size_t i = 1; i < names.size(); ++i)
    text += (i + 1 < names.size() ? ", " : " or ") + std::string(names[i]);
  return text + (names.size() > 1 ? ": the intervals overlap" : "");
}

/// The survival is null where no pair was near another.
Totals totals_of(const Arguments& arguments, const Trace& trace, const CoherenceSums& coherence,
                 const Rows& rows) {
  Totals totals;
  totals.set("frames", trace.frames)
      .set("objects", trace.objects)
      .set("pairs", trace.pairs())
      .set("volume", arguments.variant.volume)
      .set("query", arguments.variant.query);
  const auto names = candidates(rows);
  std::optional<std::string_view> fastest;
  if (can_tell(rows) && names.size() == 1) fastest = names[0];
  totals.set("survival", coherence.survival())
      .set("fastest", fastest)
      .set("candidates", joined(names))
      .set("windows", rows.back().windows)
      .set("verdict", verdict(rows, trace));
  Totals strategies;
  for (const Predicted& row : rows) {
    Totals each;
    each.set("n_v", row.n_v).set("n_p", row.n_p).set("seconds", row.seconds);
    each.set("seconds_low", row.low).set("seconds_high", row.high);
    strategies.set(std::string(row.strategy).c_str(), each);
  }
  totals.set("strategies", strategies);
  return totals;
}

void run(const Arguments& arguments) {
  check(arguments.variant);
  require_fit(arguments.variant);
  const NamedFile written[] = {
      {"the table", "/dev/stdout"}, {"--csv", arguments.csv}, {"--json", arguments.json}};
  require_places(files_read(arguments.trace, arguments.meshes), written);
  const auto meshes = read_meshes(arguments.meshes, arguments.scale);
  const Trace trace = read_trace(arguments.trace);
  require_finite_corners(trace, arguments.trace, meshes);
  PredictOptions options = options_for(trace.frames);
  if (arguments.stride || arguments.window) {
    const PredictOptions otherwise;
    options.stride = arguments.stride.value_or(otherwise.stride);
    options.window = arguments.window.value_or(otherwise.window);
  }
  const Rows rows = predict(meshes, trace, arguments.variant, options);
  if (!arguments.csv.empty())
    write_whole(arguments.csv, "strategy,n_v,n_p,seconds,seconds_low,seconds_high\n" +
                                   lines(rows, "%s,%.0f,%.0f,%.9g,%.9g,%.9g\n"));
  if (!arguments.json.empty()) {
    const CoherenceSums sums = coherence(meshes, trace, arguments.variant);
    write_totals(totals_of(arguments, trace, sums, rows), arguments.json);
  }
  std::printf("%-16s %14s %14s %12s  %s\n%s", "strategy", "n_v", "n_p", "seconds", "interval",
              lines(rows, "%-16s %14.0f %14.0f %12.6f  %.6f to %.6f\n").c_str());
  std::printf("fastest: %s\n", verdict(rows, trace).c_str());
}

}  // namespace

void add_predict(CLI::App& app) {
  CLI::App* command = app.add_subcommand("predict",
                                         "Predicts the cost of each strategy on a "
                                         "trace, from windows of it");
  command->footer(
      "On 40 motions of 600 frames, 312 of 320 intervals contained the measured time (of\n"
      "recursion's, the narrowest, 35 of 40). Intervals are wide: +-56 % of the predicted time in\n"
      "the median, so that on average 7.3 of eight strategies remained candidates. The fastest\n"
      "one was among them in all 40. To find out which candidate is the fastest, replay them.\n"
      "experiments/replay/predict_coverage repeats this measurement.");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("trace,--trace", arguments->trace, what_poses_are)->required();
  add_mesh_options(*command, arguments->meshes, arguments->scale);
  add_variant_options(
      *command, arguments->variant,
      {"volume", "fan_out", "frame", "query", "relative_error", "build", "fit", "leaf_size"});
  command
      ->add_option("--stride", arguments->stride,
                   "frames from the start of one window to the next (default: 96; a trace of fewer "
                   "than 384 frames is used whole)")
      ->check(whole_number(1, 1u << 16));
  command
      ->add_option("--window", arguments->window,
                   "frames of a window, which starts from a recursion's front (default: 48)")
      ->check(whole_number(2, 1u << 16));
  command->add_option("--csv", arguments->csv, "the table as CSV, one row for each strategy");
  command->add_option("--json", arguments->json,
                      "the table, and the survival (the share of a front that the next frame "
                      "finds again), as JSON");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
