// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab replay`: a motion trace through one variant of the engine.
#include <algorithm>
#include <optional>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/number.hpp"
#include "experiments/commands/whole_number.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/peak_bytes.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/replay/replay_budgeted.hpp"
#include "experiments/replay/scene_page.hpp"
#include "experiments/replay/topology_of.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/scene_x3d.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string trace, out, json, page, x3d, count = "off";
  std::optional<std::string> configuration;
  Variant variant;
  unsigned threads = 1;
  std::optional<std::uint64_t> budget;
};

/// What there would have been to do: every pair to consider and every volume to pose in every
/// frame, and the tests of the recursive strategy. That is played once more for it, where counting
/// was asked for. In wide trees a volume is posed for each test, so there is no such number.
void skipped(Totals& totals, const Arguments& arguments, std::span<const TriangleMesh> meshes,
             const Trace& trace, const ReplayResult& result) {
  if (arguments.count != "on" || arguments.variant.tree != "binary") {
    totals.set("skipped", nullptr);
    return;
  }
  Variant variant = arguments.variant;
  variant.strategy = "recursive";
  ReplayOptions options;
  options.count = Count::on;
  options.keep_answers = false;
  const ReplayResult recursive =
      arguments.variant.strategy == "recursive" ? result : replay(meshes, trace, variant, options);
  std::uint64_t volumes = 0;
  for (std::size_t m = 0; m < std::min(meshes.size(), trace.objects); ++m) {
    const std::size_t alike = (trace.objects - m - 1) / meshes.size() + 1;
    volumes += alike * topology_of(meshes[m], variant).nodes.size();
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

/// Null where nothing was counted.
template <class Result>
void set_counts(Totals& totals, const Arguments& arguments, const Result& result) {
  for (const auto& [key, count] :
       {std::pair{"n_u", result.n_u}, {"n_v", result.n_v}, {"n_p", result.n_p}})
    if (arguments.count == "on")
      totals.set(key, count);
    else
      totals.set(key, nullptr);
}

Totals totals_of(const Arguments& arguments, std::span<const TriangleMesh> meshes,
                 const Trace& trace, const ReplayResult& result) {
  const Variant& variant = arguments.variant;
  Totals totals = times_of(trace, result);
  totals.set(variant.query == "contacts" ? "contacts" : "touching", result.hits);
  set_counts(totals, arguments, result);
  totals.set("front", result.front)
      .set("tree", variant.tree)
      .set("volume", variant.volume)
      .set("strategy", variant.strategy)
      .set("query", variant.query)
      .set("build", variant.build)
      .set("leaf_size", variant.leaf_size)
      .set("fit", variant.fit)
      .set("precision", variant.precision)
      .set("threads", arguments.threads);
  skipped(totals, arguments, meshes, trace, result);
  return totals;
}

Totals totals_of(const Arguments& arguments, const Trace& trace, const BudgetedResult& result) {
  const Variant& variant = arguments.variant;
  Totals totals = times_of(trace, result);
  totals.set("budget", *arguments.budget)
      .set("touching", result.touching)
      .set("apart", result.apart)
      .set("unknown", result.unknown)
      .set("deepest", result.deepest)
      .set("mean_deepest", result.mean_deepest);
  set_counts(totals, arguments, result);
  totals.set("volume", variant.volume)
      .set("query", variant.query)
      .set("build", variant.build)
      .set("leaf_size", variant.leaf_size)
      .set("fit", variant.fit)
      .set("precision", variant.precision);
  return totals;
}

void write_answers(const Arguments& arguments, const Trace& trace, const ReplayResult& result) {
  if (arguments.variant.query == "touching") {
    const std::size_t shape[] = {trace.frames, trace.pairs()};
    write_npy<std::uint8_t>(arguments.out, shape, result.touching);
  } else if (arguments.variant.query == "distance") {
    const std::size_t shape[] = {trace.frames, trace.pairs()};
    write_npy<double>(arguments.out, shape, result.distances);
  } else {
    const std::size_t shape[] = {result.contacts.size(), 5};
    write_npy<std::uint32_t>(arguments.out, shape,
                             {reinterpret_cast<const std::uint32_t*>(result.contacts.data()),
                              result.contacts.size() * 5});
  }
}

std::string name(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

/// Plays the trace again, so that what was timed was not watched.
void write_page(const Arguments& arguments, std::span<const TriangleMesh> meshes,
                const Trace& trace) {
  std::vector<std::string> names;
  for (const auto& file : arguments.meshes) names.push_back(name(file));
  write_whole(arguments.page,
              scene_page(meshes, trace, arguments.variant, {names, name(arguments.trace)}));
}

/// In the words of who asked.
std::string chosen(const Arguments& arguments) {
  return arguments.configuration ? "--configuration " + *arguments.configuration
                                 : "--tree " + arguments.variant.tree;
}

void check(const Arguments& arguments) {
  check(arguments.variant);
  std::vector<NamedFile> read{{"--trace", arguments.trace}};
  for (const auto& mesh : arguments.meshes) read.push_back({"--mesh", mesh});
  const NamedFile written[] = {place_of_totals(arguments.json),
                               {"--out", arguments.out},
                               {"--page", arguments.page},
                               {"--x3d", arguments.x3d}};
  require_places(read, written);
  if (!arguments.page.empty() && arguments.variant.tree != "binary")
    throw Unusable("--page", "draws the volumes of binary trees; not with " + chosen(arguments));
  if (!arguments.budget) return;
  for (const auto& [option, file] : {std::pair("--page", arguments.page), {"--x3d", arguments.x3d}})
    if (!file.empty()) throw Unusable(option, "shows whole answers; not with --budget");
  if (arguments.variant.query != "touching")
    throw Unusable("--budget",
                   "answers whether surfaces touch; not with --query " + arguments.variant.query);
  if (arguments.configuration)
    throw Unusable("--budget", "starts from the roots of binary trees in every frame; not with " +
                                   chosen(arguments));
  if (arguments.variant.strategy != "recursive")
    throw Unusable("--budget", "starts from the roots in every frame; not with --strategy " +
                                   arguments.variant.strategy);
  if (arguments.variant.tree != "binary")
    throw Unusable("--budget",
                   "is kept over binary trees; not with --tree " + arguments.variant.tree);
  if (arguments.threads != 1) throw Unusable("--budget", "runs in one thread");
}

void run(Arguments arguments) {
  if (arguments.configuration)
    arguments.variant = configured(arguments.variant, *arguments.configuration);
  check(arguments);
  if (arguments.threads > 1 && !Threads::available)
    throw Unusable("--threads", "there is one, for TBB was not found");
  std::vector<TriangleMesh> meshes;
  for (const auto& file : arguments.meshes) meshes.push_back(read_mesh(file));
  const Trace trace = read_trace(arguments.trace);
  require_finite_corners(trace, arguments.trace, meshes);
  const Count count = arguments.count == "on" ? Count::on : Count::off;
  if (arguments.budget) {
    const BudgetedResult result =
        replay_budgeted(meshes, trace, arguments.variant, *arguments.budget, count);
    if (!arguments.out.empty()) {
      const std::size_t shape[] = {trace.frames, trace.pairs()};
      write_npy<std::uint8_t>(arguments.out, shape, result.known);
    }
    return write_totals(totals_of(arguments, trace, result), arguments.json);
  }
  ReplayOptions options;
  options.count = count;
  options.threads = arguments.threads;
  options.keep_answers = !arguments.out.empty() || !arguments.x3d.empty();
  const ReplayResult result = replay(meshes, trace, arguments.variant, options);
  const Totals totals = totals_of(arguments, meshes, trace, result);
  if (!arguments.out.empty()) write_answers(arguments, trace, result);
  if (!arguments.page.empty()) write_page(arguments, meshes, trace);
  if (!arguments.x3d.empty())
    write_whole(arguments.x3d, scene_x3d(meshes, trace, result.touching, name(arguments.trace)));
  write_totals(totals, arguments.json);
}

}  // namespace

void add_replay(CLI::App& app) {
  CLI::App* command = app.add_subcommand("replay", "Plays a motion trace through the engine");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("--mesh", arguments->meshes, "mesh file; object i uses mesh i mod their number")
      ->required();
  command->add_option("--trace", arguments->trace, "poses: .npy, float64, (frames, objects, 7)")
      ->required();
  command->add_option("--volume", arguments->variant.volume, "see `bvlab list volumes`")
      ->capture_default_str();
  command->add_option("--tree", arguments->variant.tree, "see `bvlab list trees`")
      ->capture_default_str();
  command
      ->add_option("--strategy", arguments->variant.strategy,
                   "see `bvlab list strategies`; name or name:parameter")
      ->capture_default_str();
  command->add_option("--build", arguments->variant.build, "see `bvlab list builds`")
      ->capture_default_str();
  command->add_option("--fit", arguments->variant.fit, "of volumes: published, or tight")
      ->capture_default_str();
  command
      ->add_option("--leaf-size", arguments->variant.leaf_size,
                   "triangles in a leaf, at most; in wide trees no more than children in a node")
      ->check(whole_number(1, 1u << 16))
      ->capture_default_str();
  CLI::Option* configuration = command->add_option_function<std::string>(
      "--configuration", [arguments](const std::string& name) { arguments->configuration = name; },
      "all of these at once, see `bvlab list configurations`");
  CLI::Option* recommended = command->add_flag_callback(
      "--recommended", [arguments] { arguments->configuration = "recommended"; },
      "the same as --configuration recommended");
  for (const char* part : {"--volume", "--tree", "--strategy", "--build", "--fit", "--leaf-size"}) {
    configuration->excludes(command->get_option(part));
    recommended->excludes(command->get_option(part));
  }
  recommended->excludes(configuration);
  command->add_option("--query", arguments->variant.query, "see `bvlab list queries`")
      ->capture_default_str();
  command
      ->add_option("--relative-error", arguments->variant.relative_error,
                   "distances may be at most this part above the exact one, never below")
      ->check(number())
      ->capture_default_str();
  command->add_option("--precision", arguments->variant.precision, "see `bvlab list precisions`")
      ->capture_default_str();
  command
      ->add_option(
          "--budget", arguments->budget,
          "at most this many volume tests for each pair and frame: 0 apart, 1 touching, 2 not "
          "known yet, with a bound on how deep")
      ->check(whole_number(0, 1u << 30));
  command
      ->add_option("--threads", arguments->threads,
                   "that share the pairs of a frame; answers are the same")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option("--count", arguments->count, "on: fill n_u, n_v, n_p (and time that)")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "result array");
  command->add_option("--page", arguments->page, "the scene in 3D: one HTML file, needs no other");
  command->add_option("--x3d", arguments->x3d,
                      "the scene for other viewers, in X3D; red what touches (--query touching)");
  command->add_option("--json", arguments->json, "totals; to standard output where not given");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
