// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab boxes`: a box trace through one broad-phase method.
#include <unistd.h>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/number.hpp"
#include "experiments/commands/require_threads.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/replay/replay_boxes.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::string trace, coherent = "on", out, json;
  BoxReplayOptions options;
};

template <class T>
void play(const Arguments& arguments, const Array<T>& trace) {
  const BoxTrace<T> frames{
      trace.shape[0],
      trace.shape[1],
      {reinterpret_cast<const Box<T>*>(trace.data.data()), trace.shape[0] * trace.shape[1]},
      arguments.trace};
  const BoxReplayResult result = replay_boxes(frames, arguments.options);
  if (!result.reason.empty() && isatty(STDERR_FILENO))
    std::fprintf(stderr, "%s: %s\n", arguments.options.method.c_str(), result.reason.c_str());
  if (!arguments.out.empty()) write_npy_rows<std::uint32_t, 3>(arguments.out, result.pairs);
  write_totals(totals_of(result, frames, arguments.options), arguments.json);
}

void run(Arguments arguments) {
  require_threads(static_cast<std::size_t>(arguments.options.threads));
  check(arguments.options);  // before the file is read
  const NamedFile read[] = {{"--trace", arguments.trace}};
  const NamedFile written[] = {place_of_totals(arguments.json), {"--out", arguments.out}};
  require_places(read, written);
  arguments.options.coherence = arguments.coherent == "on" ? Coherence::on : Coherence::off;
  arguments.options.keep_pairs = !arguments.out.empty();
  static constexpr std::size_t shape[] = {any_length, any_length, 6};
  const auto trace = read_npy_floating(arguments.trace, shape);
  std::visit([&](const auto& array) { play(arguments, array); }, trace);
}

}  // namespace

void add_boxes(CLI::App& app) {
  CLI::App* command = app.add_subcommand("boxes", "Finds the overlapping pairs of a box trace");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("--trace", arguments->trace,
                   "boxes: .npy, float32 or float64, (frames, boxes, 6)")
      ->required();
  command->add_option("--method", arguments->options.method, "see `bvlab list methods`")
      ->capture_default_str();
  command->add_option("--coherent", arguments->coherent, "off: start every frame from scratch")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--precision", arguments->options.precision,
                   "exact or float64: the exact pairs of the trace; float32: boxes are rounded "
                   "outward, so no pair is missed, and pairs that nearly touch may be reported")
      ->capture_default_str();
  command
      ->add_option("--threads", arguments->options.threads,
                   "number of threads; the pairs do not depend on it")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option("--out", arguments->out,
                      "overlapping pairs: uint32 (k, 3) of frame, i, j, sorted");
  command->add_option("--json", arguments->json, "totals (default: standard output)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
