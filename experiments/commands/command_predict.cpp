// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab predict`: what each strategy would cost on a trace.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/whole_number.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/coherence.hpp"
#include "experiments/replay/predict.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string trace, json, csv;
  Variant variant;
  PredictOptions options;
};

using Rows = std::vector<Predicted>;

/// By `format`, of the strategy, n_v, n_p and seconds.
std::string lines(const Rows& rows, const char* format) {
  std::string text;
  for (const Predicted& row : rows) {
    char line[160];
    std::snprintf(line, sizeof line, format, std::string(row.strategy).c_str(), row.n_v, row.n_p,
                  row.seconds);
    text += line;
  }
  return text;
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
  if (coherence.entries > 0)
    totals.set("survival",
               static_cast<double>(coherence.kept) / static_cast<double>(coherence.entries));
  else
    totals.set("survival", nullptr);
  totals.set("fastest", fastest(rows));
  Totals strategies;
  for (const Predicted& row : rows) {
    Totals each;
    each.set("n_v", row.n_v).set("n_p", row.n_p).set("seconds", row.seconds);
    strategies.set(std::string(row.strategy).c_str(), each);
  }
  totals.set("strategies", strategies);
  return totals;
}

void run(const Arguments& arguments) {
  const std::string& query = arguments.variant.query;
  check(arguments.variant);
  if (query != "touching" && query != "contacts")
    throw Unusable("--query", "predicted are touching and contacts, not " + query);
  std::vector<NamedFile> read{{"--trace", arguments.trace}};
  for (const auto& mesh : arguments.meshes) read.push_back({"--mesh", mesh});
  const NamedFile written[] = {
      {"the table", "/dev/stdout"}, {"--csv", arguments.csv}, {"--json", arguments.json}};
  require_places(read, written);
  std::vector<TriangleMesh> meshes;
  for (const auto& file : arguments.meshes) meshes.push_back(read_mesh(file));
  const Trace trace = read_trace(arguments.trace);
  require_finite_corners(trace, arguments.trace, meshes);
  const Rows rows = predict(meshes, trace, arguments.variant, arguments.options);
  if (!arguments.csv.empty())
    write_whole(arguments.csv, "strategy,n_v,n_p,seconds\n" + lines(rows, "%s,%.0f,%.0f,%.9g\n"));
  if (!arguments.json.empty()) {
    const CoherenceSums sums = coherence(meshes, trace, arguments.variant);
    write_totals(totals_of(arguments, trace, sums, rows), arguments.json);
  }
  std::printf("%-16s %14s %14s %12s\n%s", "strategy", "n_v", "n_p", "seconds",
              lines(rows, "%-16s %14.0f %14.0f %12.6f\n").c_str());
  std::printf("fastest: %s\n", std::string(fastest(rows)).c_str());
}

}  // namespace

void add_predict(CLI::App& app) {
  CLI::App* command = app.add_subcommand("predict",
                                         "What each strategy would cost on a trace, from "
                                         "recursions and windows begun at their fronts");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("trace,--trace", arguments->trace, "poses: .npy, float64, (frames, objects, 7)")
      ->required();
  command
      ->add_option("--mesh", arguments->meshes, "mesh file; object i uses mesh i mod their number")
      ->required();
  command->add_option("--volume", arguments->variant.volume, "see `bvlab list volumes`")
      ->capture_default_str();
  command->add_option("--query", arguments->variant.query, "touching or contacts")
      ->capture_default_str();
  command->add_option("--build", arguments->variant.build, "see `bvlab list builds`")
      ->capture_default_str();
  command->add_option("--fit", arguments->variant.fit, "of volumes: published, or tight")
      ->capture_default_str();
  command->add_option("--leaf-size", arguments->variant.leaf_size, "triangles in a leaf, at most")
      ->check(whole_number(1, 1u << 16))
      ->capture_default_str();
  command
      ->add_option("--stride", arguments->options.stride,
                   "a window begins in every so-many-th frame, about")
      ->check(whole_number(1, 1u << 16))
      ->capture_default_str();
  command
      ->add_option("--window", arguments->options.window,
                   "frames for which strategies are followed from a recursion's front")
      ->check(whole_number(2, 1u << 16))
      ->capture_default_str();
  command->add_option("--csv", arguments->csv, "the table, one row a strategy");
  command->add_option("--json", arguments->json,
                      "the same and how much of the front survives a frame, as an object");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
