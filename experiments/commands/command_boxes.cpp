// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab boxes`: a box trace through one broad-phase method.
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "broadphase/box.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/whole_number.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/peak_bytes.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/box_methods.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

constexpr float max_float = std::numeric_limits<float>::max();

struct Arguments {
  std::string trace, method = "auto", coherent = "on", precision = "exact", out, json;
  int threads = 1;
};

struct Found {
  double seconds = 0;        // from boxes to pairs, every frame
  double first_seconds = 0;  // the first frame of these
  double build_seconds = 0;  // making the method
  std::uint64_t overlaps = 0;
  std::string reason;
  std::vector<std::array<std::uint32_t, 3>> rows;  // frame, i, j
};

void keep(std::vector<std::array<std::uint32_t, 3>>& rows, std::size_t frame,
          std::span<const Pair> pairs) {
  const auto first = static_cast<std::ptrdiff_t>(rows.size());
  for (const Pair& pair : pairs)
    rows.push_back({static_cast<std::uint32_t>(frame), pair.i, pair.j});
  std::sort(rows.begin() + first, rows.end());
}

template <class T>
void refuse_faults(const Arguments& arguments, const Array<T>& trace) {
  const std::size_t count = trace.shape[1];
  const Boxes<T> all(reinterpret_cast<const Box<T>*>(trace.data.data()), trace.shape[0] * count);
  if (const auto fault = first_fault(all))
    throw Unusable(arguments.trace, "frame " + std::to_string(fault->box / count) + ", box " +
                                        std::to_string(fault->box % count) + ": " +
                                        std::string(fault->what));
}

/// A float that is not above (below) x, next to it or equal; the largest where x is beyond them.
float outward_down(double x) { return std::max(rounded_down<float>(x), -max_float); }
float outward_up(double x) { return std::min(rounded_up<float>(x), max_float); }

/// The boxes in float32, each as small as encloses its own: pairs that overlap still do.
Array<float> rounded_outward(const Array<double>& trace) {
  Array<float> rounded;
  rounded.shape = trace.shape;
  rounded.data.resize(trace.data.size());
  for (std::size_t k = 0; k < trace.data.size(); ++k)
    rounded.data[k] = k % 6 < 3 ? outward_down(trace.data[k]) : outward_up(trace.data[k]);
  return rounded;
}

template <class T>
Found find(const Arguments& arguments, const Array<T>& trace) {
  const std::size_t frames = trace.shape[0], count = trace.shape[1];
  const Boxes<T> all(reinterpret_cast<const Box<T>*>(trace.data.data()), frames * count);
  if (count > 0xfffffffeu || frames > 0xffffffffu)
    throw Unusable(arguments.trace, "more boxes or frames than 32-bit indices can name");
  refuse_faults(arguments, trace);
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  MethodSettings settings;
  settings.coherence = arguments.coherent == "on" ? Coherence::on : Coherence::off;
  settings.threads = arguments.threads;
  Found found;
  const auto start = Clock::now();
  const auto method = make_method<T>(arguments.method, settings);
  found.build_seconds = seconds_since(start);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto frame_start = Clock::now();
    const auto pairs = method->overlapping(all.subspan(frame * count, count));
    const double seconds = seconds_since(frame_start);
    found.seconds += seconds;
    if (frame == 0) found.first_seconds = seconds;
    found.overlaps += pairs.size();
    if (!arguments.out.empty()) keep(found.rows, frame, pairs);
  }
  found.reason = method->reason();
  return found;
}

void run(const Arguments& arguments) {
  if (arguments.threads > 1 && !Threads::available)
    throw Unusable("--threads", "there is one, for TBB was not found");
  make_method<float>(arguments.method,
                     MethodSettings{});  // refuses an unknown name before the file is read
  if (!Precisions::with(arguments.precision, [](auto) {}))
    throw Unusable("--precision",
                   "unknown name '" + arguments.precision + "'; there are " + Precisions::names());
  const NamedFile read[] = {{"--trace", arguments.trace}};
  const NamedFile written[] = {place_of_totals(arguments.json), {"--out", arguments.out}};
  require_places(read, written);
  static constexpr std::size_t shape[] = {any_length, any_length, 6};
  const auto trace = read_npy_floating(arguments.trace, shape);
  const auto* wide = std::get_if<Array<double>>(&trace);
  const bool narrowed = wide && arguments.precision == Float32::name;
  if (narrowed) refuse_faults(arguments, *wide);  // of the boxes as they were given
  const Found found =
      narrowed ? find(arguments, rounded_outward(*wide))
               : std::visit([&](const auto& array) { return find(arguments, array); }, trace);
  const auto& sizes = std::visit(
      [](const auto& array) -> const auto& { return array.shape; }, trace);
  const std::uint64_t boxes = sizes[1];
  Totals totals;
  totals.set("seconds", found.seconds)
      .set("build_seconds", found.build_seconds)
      .set("first_seconds", found.first_seconds)
      .set("peak_bytes", peak_bytes())
      .set("frames", sizes[0])
      .set("boxes", boxes)
      .set("pairs", boxes < 2 ? 0 : boxes * (boxes - 1) / 2)
      .set("overlaps", found.overlaps)
      .set("method", arguments.method)
      .set("coherent", arguments.coherent)
      .set("precision", arguments.precision)
      .set("scalar", wide && !narrowed ? "double" : "float")
      .set("threads", arguments.threads);
  if (!found.reason.empty()) totals.set("reason", found.reason);
  if (!found.reason.empty() && isatty(STDERR_FILENO))
    std::fprintf(stderr, "%s: %s\n", arguments.method.c_str(), found.reason.c_str());
  if (!arguments.out.empty()) {
    const std::size_t rows[] = {found.rows.size(), 3};
    write_npy<std::uint32_t>(
        arguments.out, rows,
        {reinterpret_cast<const std::uint32_t*>(found.rows.data()), found.rows.size() * 3});
  }
  write_totals(totals, arguments.json);
}

}  // namespace

void add_boxes(CLI::App& app) {
  CLI::App* command = app.add_subcommand("boxes", "Finds the overlapping pairs of a box trace");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("--trace", arguments->trace,
                   "boxes: .npy, float32 or float64, (frames, boxes, 6)")
      ->required();
  command->add_option("--method", arguments->method, "see `bvlab list methods`")
      ->capture_default_str();
  command->add_option("--coherent", arguments->coherent, "off: every frame as if it were the first")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--precision", arguments->precision,
                   "exact, float64: comparisons of coordinates are exact at either, so both give "
                   "the pairs of the trace; float32: a float64 trace rounded outward, so no pair "
                   "is missed, and some that all but touch are called overlapping")
      ->capture_default_str();
  command->add_option("--threads", arguments->threads, "that share a frame; the pairs are the same")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option("--out", arguments->out,
                      "overlapping pairs: uint32 (k, 3), frame, i, j, sorted");
  command->add_option("--json", arguments->json, "totals; to standard output where not given");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
