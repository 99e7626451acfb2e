// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab replay`: a motion trace through one variant of the engine.
#include <nlohmann/json.hpp>

#include "experiments/files/npy.hpp"
#include "experiments/files/peak_bytes.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/runner/commands.hpp"
#include "experiments/runner/replay.hpp"
#include "experiments/runner/whole_number.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string trace, out, json, count = "off";
  Variant variant;
  unsigned threads = 1;
};

nlohmann::ordered_json totals_of(const Arguments& arguments, const Trace& trace,
                                 const ReplayResult& result) {
  const bool counted = arguments.count == "on";
  const auto count = [&](auto value) {
    return counted ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  return {{"seconds", result.seconds},
          {"build_seconds", result.build_seconds},
          {"first_seconds", result.first_seconds},
          {"peak_bytes", peak_bytes()},
          {"frames", trace.frames},
          {"objects", trace.objects},
          {"pairs", trace.pairs()},
          {arguments.variant.query == "contacts" ? "contacts" : "touching", result.hits},
          {"n_u", count(result.n_u)},
          {"n_v", count(result.n_v)},
          {"n_p", count(result.n_p)},
          {"front", result.front},
          {"volume", arguments.variant.volume},
          {"strategy", arguments.variant.strategy},
          {"query", arguments.variant.query},
          {"build", arguments.variant.build},
          {"leaf_size", arguments.variant.leaf_size},
          {"precision", arguments.variant.precision},
          {"threads", arguments.threads}};
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

void run(const Arguments& arguments) {
  check(arguments.variant);
  require_place("--out", arguments.out);
  require_place("--json", arguments.json);
  std::vector<TriangleMesh> meshes;
  for (const auto& file : arguments.meshes) meshes.push_back(read_mesh(file));
  const Trace trace = read_trace(arguments.trace);
  ReplayOptions options;
  options.count = arguments.count == "on" ? Count::on : Count::off;
  options.threads = arguments.threads;
  options.keep_answers = !arguments.out.empty();
  const ReplayResult result = replay(meshes, trace, arguments.variant, options);
  const std::string totals = totals_of(arguments, trace, result).dump(2) + "\n";
  if (!arguments.out.empty()) write_answers(arguments, trace, result);
  if (!arguments.json.empty()) write_whole(arguments.json, totals);
  if (arguments.json.empty()) std::fputs(totals.c_str(), stdout);
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
  command
      ->add_option("--strategy", arguments->variant.strategy,
                   "see `bvlab list strategies`; name or name:parameter")
      ->capture_default_str();
  command->add_option("--query", arguments->variant.query, "see `bvlab list queries`")
      ->capture_default_str();
  command->add_option("--build", arguments->variant.build, "see `bvlab list builds`")
      ->capture_default_str();
  command->add_option("--leaf-size", arguments->variant.leaf_size, "triangles in a leaf, at most")
      ->check(whole_number(1, 1u << 16))
      ->capture_default_str();
  command
      ->add_option("--relative-error", arguments->variant.relative_error,
                   "distances may be so much above the truth, never below")
      ->capture_default_str();
  command->add_option("--precision", arguments->variant.precision, "see `bvlab list precisions`")
      ->capture_default_str();
  command->add_option("--threads", arguments->threads)
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option("--count", arguments->count, "on: fill n_u, n_v, n_p (and time that)")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "result array");
  command->add_option("--json", arguments->json, "totals; to standard output where not given");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
