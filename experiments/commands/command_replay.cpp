// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab replay`: a motion trace through one variant of the engine.
#include <optional>
#include <string_view>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/require_threads.hpp"
#include "experiments/commands/variant_options.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/replay/replay_budgeted.hpp"
#include "experiments/replay/replay_totals.hpp"
#include "experiments/replay/scene_page.hpp"
#include "experiments/scenes/pair_files.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string trace, out, nearest, json, page, count = "off", broad_phase = "auto";
  PairFiles pairs;
  std::optional<std::string> configuration;
  Variant variant;
  unsigned threads = 1;
  std::optional<std::uint64_t> budget;
  double scale = 1;
};

void write_answers(const Arguments& arguments, const Trace& trace, const ReplayResult& result) {
  const AnswerKind kind = kind_of_answers(result, arguments.variant.query);
  const std::size_t shape[] = {trace.frames, trace.pairs()};
  if (kind == AnswerKind::yes_or_no)
    write_npy<std::uint8_t>(arguments.out, shape, result.touching);
  else if (kind == AnswerKind::number)
    write_npy<double>(arguments.out, shape, result.distances);
  else
    write_npy_rows<std::uint32_t, 5>(arguments.out, result.contacts);
}

void write_nearest(const Arguments& arguments, const Trace& trace, const ReplayResult& result) {
  static_assert(sizeof(NearestPair) == 2 * sizeof(std::uint32_t) + 6 * sizeof(double));
  const std::size_t shape[] = {trace.frames, trace.pairs()};
  write_npy_records(arguments.nearest, "[('triangles', '<u4', (2,)), ('points', '<f8', (2, 3))]",
                    shape, std::as_bytes(std::span(result.nearest)));
}

std::string name(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

/// Plays the trace again, so that what was timed was not watched.
void write_page(const Arguments& arguments, std::span<const TriangleMesh> meshes,
                const Trace& trace) {
  std::vector<std::string> names;
  names.reserve(arguments.meshes.size());
  for (const auto& file : arguments.meshes) names.push_back(name(file));
  write_whole(arguments.page,
              scene_page(meshes, trace, arguments.variant, {names, name(arguments.trace)}));
}

/// In the words of the command line.
std::string chosen(const Arguments& arguments) {
  return arguments.configuration ? "--configuration " + *arguments.configuration
                                 : "--kernel " + arguments.variant.kernel;
}

void check(const Arguments& arguments) {
  check(arguments.variant);
  auto read = files_read(arguments.trace, arguments.meshes);
  for (const auto& [option, file] : {std::pair("--pairs", arguments.pairs.pairs),
                                     {"--without", arguments.pairs.without},
                                     {"--groups", arguments.pairs.groups}})
    if (!file.empty()) read.push_back({option, file});
  const NamedFile written[] = {place_of_totals(arguments.json),
                               {"--out", arguments.out},
                               {"--nearest", arguments.nearest},
                               {"--page", arguments.page}};
  require_places(read, written);
  if (!arguments.page.empty() &&
      (arguments.variant.kernel != "gathered" || arguments.variant.fan_out != 2))
    throw Unusable("--page", "draws the volumes of binary trees; not with " +
                                 (arguments.configuration || arguments.variant.kernel != "gathered"
                                      ? chosen(arguments)
                                      : "--fan-out " + std::to_string(arguments.variant.fan_out)));
  if (!arguments.configuration) require_fit(arguments.variant);
  if (!arguments.nearest.empty() && arguments.variant.query != "distance")
    throw Unusable("--nearest", "is for --query distance; not for " + arguments.variant.query);
  if (arguments.broad_phase == "on" && arguments.variant.query == "distance")
    throw Unusable("--broad-phase on",
                   "not with --query distance, which has an answer for every pair");
  if (!arguments.pairs.say_nothing() && !arguments.page.empty())
    throw Unusable("--page", "shows all pairs; not with --pairs, --without or --groups");
  if (!arguments.budget) return;
  if (!arguments.page.empty()) throw Unusable("--page", "shows whole answers; not with --budget");
  if (arguments.variant.query != "touching")
    throw Unusable("--budget",
                   "answers whether surfaces touch; not with --query " + arguments.variant.query);
  if (arguments.configuration)
    throw Unusable("--budget",
                   "starts from the roots in every frame; not with " + chosen(arguments));
  if (arguments.variant.strategy != "recursive")
    throw Unusable("--budget", "starts from the roots in every frame; not with --strategy " +
                                   arguments.variant.strategy);
  if (arguments.variant.kernel != "gathered")
    throw Unusable("--budget", "is for the kernel gathered; not with " + chosen(arguments));
  if (arguments.threads != 1) throw Unusable("--budget", "runs in one thread");
}

void run(Arguments arguments) {
  if (arguments.configuration)
    arguments.variant = configured(arguments.variant, *arguments.configuration);
  check(arguments);
  require_threads(arguments.threads);
  const auto meshes = read_meshes(arguments.meshes, arguments.scale);
  Trace trace = read_trace(arguments.trace);
  trace.chosen = chosen_from(read_pair_arrays(arguments.pairs), trace.objects);
  require_finite_corners(trace, arguments.trace, meshes);
  const BroadPhase broad_phase = broad_phase_from(arguments.broad_phase);
  const Count count = arguments.count == "on" ? Count::on : Count::off;
  if (arguments.budget) {
    const BudgetedResult result =
        replay_budgeted(meshes, trace, arguments.variant, *arguments.budget, count);
    if (!arguments.out.empty()) {
      const std::size_t shape[] = {trace.frames, trace.pairs()};
      write_npy<std::uint8_t>(arguments.out, shape, result.known);
    }
    return write_totals(totals_of(result, trace, arguments.variant, *arguments.budget, count),
                        arguments.json);
  }
  ReplayOptions options;
  options.count = count;
  options.threads = arguments.threads;
  options.keep_answers = !arguments.out.empty();
  options.keep_nearest = !arguments.nearest.empty();
  options.broad_phase = broad_phase;
  const ReplayResult result = replay(meshes, trace, arguments.variant, options);
  Totals totals = totals_of(result, meshes, trace, arguments.variant, options);
  if (!arguments.out.empty()) write_answers(arguments, trace, result);
  if (!arguments.nearest.empty()) write_nearest(arguments, trace, result);
  if (!arguments.page.empty()) write_page(arguments, meshes, trace);
  write_totals(totals, arguments.json);
}

}  // namespace

void add_replay(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "replay", "Answers a query for every pair of bodies in every frame of a trace");
  auto arguments = std::make_shared<Arguments>();
  add_mesh_options(*command, arguments->meshes, arguments->scale);
  command->add_option("--trace", arguments->trace, what_poses_are)->required();
  add_variant_options(
      *command, arguments->variant,
      {"volume", "strategy", "build", "leaf_size", "fit", "fan_out", "frame", "kernel"});
  CLI::Option* configuration = command->add_option_function<std::string>(
      "--configuration", [arguments](const std::string& name) { arguments->configuration = name; },
      "sets all of the above at once; see `bvlab list configurations`");
  CLI::Option* recommended = command->add_flag_callback(
      "--recommended", [arguments] { arguments->configuration = "recommended"; },
      "the same as --configuration recommended");
  for (const std::string_view name : set_by_configuration()) {
    configuration->excludes(command->get_option(option_of(name)));
    recommended->excludes(command->get_option(option_of(name)));
  }
  recommended->excludes(configuration);
  add_variant_options(*command, arguments->variant, {"query", "relative_error", "precision"});
  command
      ->add_option(
          "--budget", arguments->budget,
          "most volume tests for a pair in a frame; answers are 0 apart, 1 touching, 2 unknown, "
          "with a bound on the patches that may still cross")
      ->check(whole_number(0, 1u << 30));
  command
      ->add_option("--threads", arguments->threads,
                   "number of threads; answers do not depend on it")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command
      ->add_option("--count", arguments->count,
                   "on: count n_u, n_v and n_p; times then include the counting")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command->add_option("--out", arguments->out,
                      "answers, as .npy: touching uint8 and distance float64 (frames, pairs); "
                      "contacts uint32 (k, 5) of frame, i, j, triangle of i, of j, sorted. Pairs "
                      "are (0,1) (0,2) ... (1,2) ... without those left out; with --pairs, column "
                      "k is row k of that file");
  command->add_option(
      "--nearest", arguments->nearest,
      "with --query distance, of each pair the nearest triangles and points, as .npy: (frames, "
      "pairs) of records: triangles (2,) uint32, of i and of j, and points (2, 3) float64, on i "
      "and on j, in the world. Points are exact up to the rounding of their coordinates; surfaces "
      "that touch have one common point. Of several nearest pairs any; the same for any number of "
      "threads");
  command->add_option("--pairs", arguments->pairs.pairs,
                      "asks about these pairs alone: .npy, uint32 or int64, (k, 2) of objects, in "
                      "the order of the answers");
  command->add_option("--without", arguments->pairs.without,
                      "leaves these pairs out: .npy, uint32 or int64, (k, 2) of objects");
  command->add_option("--groups", arguments->pairs.groups,
                      "leaves out pairs within a group: .npy, uint32 or int64, (objects,), the "
                      "group of each object; negative: in none");
  command
      ->add_option("--broad-phase", arguments->broad_phase,
                   "on: only pairs whose boxes overlap are queried, all others are apart (answers "
                   "are the same, counts are not); off: every pair is; auto: on for many bodies, "
                   "where nothing is counted")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  command->add_option("--page", arguments->page,
                      "the scene in 3D, as one self-contained HTML file");
  command->add_option("--json", arguments->json, "totals (default: standard output)");
  command->callback([arguments, command] {
    // What is not said is what the kernel is compiled for.
    if (arguments->variant.kernel != "gathered") {
      Variant compiled;
      set_kernel(compiled, arguments->variant.kernel);
      if (command->count("--fan-out") == 0) arguments->variant.fan_out = compiled.fan_out;
      if (command->count("--frame") == 0) arguments->variant.frame = compiled.frame;
    }
    run(*arguments);
  });
}

}  // namespace bvlab
