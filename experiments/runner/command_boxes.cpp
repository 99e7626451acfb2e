// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab boxes`: a box trace through one broad-phase method.
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "broadphase/box.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/peak_bytes.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/runner/box_methods.hpp"
#include "experiments/runner/commands.hpp"
#include "experiments/runner/whole_number.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::string trace, method = "auto", coherent = "on", out, json;
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
Found find(const Arguments& arguments, const Array<T>& trace) {
  const std::size_t frames = trace.shape[0], count = trace.shape[1];
  const Boxes<T> all(reinterpret_cast<const Box<T>*>(trace.data.data()), frames * count);
  if (count > 0xfffffffeu || frames > 0xffffffffu)
    throw Unusable(arguments.trace, "more boxes or frames than 32-bit indices can name");
  if (const auto fault = first_fault(all))
    throw Unusable(arguments.trace, "frame " + std::to_string(fault->box / count) + ", box " +
                                        std::to_string(fault->box % count) + ": " +
                                        std::string(fault->what));
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
  make_method<float>(arguments.method,
                     MethodSettings{});  // refuses an unknown name before the file is read
  require_place("--out", arguments.out);
  require_place("--json", arguments.json);
  static constexpr std::size_t shape[] = {any_length, any_length, 6};
  const auto trace = read_npy_floating(arguments.trace, shape);
  const Found found = std::visit([&](const auto& array) { return find(arguments, array); }, trace);
  const auto& sizes = std::visit(
      [](const auto& array) -> const auto& { return array.shape; }, trace);
  const std::uint64_t boxes = sizes[1];
  nlohmann::ordered_json totals = {{"seconds", found.seconds},
                                   {"build_seconds", found.build_seconds},
                                   {"first_seconds", found.first_seconds},
                                   {"peak_bytes", peak_bytes()},
                                   {"frames", sizes[0]},
                                   {"boxes", boxes},
                                   {"pairs", boxes < 2 ? 0 : boxes * (boxes - 1) / 2},
                                   {"overlaps", found.overlaps},
                                   {"method", arguments.method},
                                   {"coherent", arguments.coherent},
                                   {"precision", trace.index() == 0 ? "float" : "double"},
                                   {"threads", arguments.threads}};
  if (!found.reason.empty()) totals["reason"] = found.reason;
  if (!arguments.out.empty()) {
    const std::size_t rows[] = {found.rows.size(), 3};
    write_npy<std::uint32_t>(
        arguments.out, rows,
        {reinterpret_cast<const std::uint32_t*>(found.rows.data()), found.rows.size() * 3});
  }
  const std::string text = totals.dump(2) + "\n";
  if (arguments.json.empty())
    std::fputs(text.c_str(), stdout);
  else
    write_whole(arguments.json, text);
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
  command->add_option("--threads", arguments->threads)
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command->add_option("--out", arguments->out,
                      "overlapping pairs: uint32 (k, 3), frame, i, j, sorted");
  command->add_option("--json", arguments->json, "totals; to standard output where not given");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
