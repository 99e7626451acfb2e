// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/replay_boxes.hpp"

#include <algorithm>
#include <chrono>
#include <type_traits>

#include "experiments/files/memory.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/box_methods.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

constexpr float max_float = std::numeric_limits<float>::max();

template <class T>
void refuse_faults(const BoxTrace<T>& trace) {
  if (const auto fault = first_fault(trace.all))
    throw Unusable(trace.name, "frame " + std::to_string(fault->box / trace.boxes) + ", box " +
                                   std::to_string(fault->box % trace.boxes) + ": " +
                                   std::string(fault->what));
}

/// A float that is not above (below) x, next to it or equal; the largest where x is beyond them.
float outward_down(double x) { return std::max(rounded_down<float>(x), -max_float); }
float outward_up(double x) { return std::min(rounded_up<float>(x), max_float); }

/// The boxes in float32, each as small as encloses its own: pairs that overlap still do.
std::vector<Box<float>> rounded_outward(Boxes<double> boxes) {
  std::vector<Box<float>> rounded(boxes.size());
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) {
      rounded[k].lo[axis] = outward_down(boxes[k].lo[axis]);
      rounded[k].hi[axis] = outward_up(boxes[k].hi[axis]);
    }
  return rounded;
}

void keep(std::vector<std::array<std::uint32_t, 3>>& rows, std::size_t frame,
          std::span<const Pair> pairs) {
  const auto first = static_cast<std::ptrdiff_t>(rows.size());
  for (const Pair& pair : pairs)
    rows.push_back({static_cast<std::uint32_t>(frame), pair.i, pair.j});
  std::sort(rows.begin() + first, rows.end());
}

template <class T>
BoxReplayResult play(const BoxTrace<T>& trace, const BoxReplayOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  MethodSettings settings;
  settings.coherence = options.coherence;
  settings.threads = options.threads;
  BoxReplayResult result;
  result.scalar = std::is_same_v<T, float> ? "float" : "double";
  const auto start = Clock::now();
  const auto method = make_method<T>(options.method, settings);
  result.build_seconds = seconds_since(start);
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    const auto frame_start = Clock::now();
    const auto pairs = method->overlapping(trace.all.subspan(frame * trace.boxes, trace.boxes));
    const double seconds = seconds_since(frame_start);
    result.seconds += seconds;
    if (frame == 0) result.first_seconds = seconds;
    result.overlaps += pairs.size();
    if (options.keep_pairs) keep(result.pairs, frame, pairs);
    if (options.after_frame) options.after_frame(frame);
  }
  result.reason = method->reason();
  return result;
}

}  // namespace

void check(const BoxReplayOptions& options) {
  make_method<float>(options.method, MethodSettings{});
  if (!Precisions::with(options.precision, [](auto) {}))
    throw Unusable("--precision",
                   "unknown name '" + options.precision + "'; available: " + Precisions::names());
}

template <class T>
BoxReplayResult replay_boxes(const BoxTrace<T>& trace, const BoxReplayOptions& options) {
  check(options);
  if (trace.boxes > 0xfffffffeu || trace.frames > 0xffffffffu)
    throw Unusable(trace.name, "more boxes or frames than 32-bit indices can name");
  refuse_faults(trace);
  if constexpr (std::is_same_v<T, double>)
    if (options.precision == Float32::name) {
      const auto rounded = rounded_outward(trace.all);
      return play(BoxTrace<float>{trace.frames, trace.boxes, rounded, trace.name}, options);
    }
  return play(trace, options);
}

template <class T>
Totals totals_of(const BoxReplayResult& result, const BoxTrace<T>& trace,
                 const BoxReplayOptions& options) {
  Totals totals;
  const std::uint64_t boxes = trace.boxes;
  totals.set("seconds", result.seconds)
      .set("build_seconds", result.build_seconds)
      .set("first_seconds", result.first_seconds)
      .set("peak_bytes", peak_bytes())
      .set("frames", trace.frames)
      .set("boxes", boxes)
      .set("pairs", boxes < 2 ? 0 : boxes * (boxes - 1) / 2)
      .set("overlaps", result.overlaps)
      .set("method", options.method)
      .set("coherent", options.coherence == Coherence::on ? "on" : "off")
      .set("precision", options.precision)
      .set("scalar", result.scalar)
      .set("threads", options.threads);
  if (!result.reason.empty()) totals.set("reason", result.reason);
  return totals;
}

template BoxReplayResult replay_boxes(const BoxTrace<float>&, const BoxReplayOptions&);
template BoxReplayResult replay_boxes(const BoxTrace<double>&, const BoxReplayOptions&);
template Totals totals_of(const BoxReplayResult&, const BoxTrace<float>&, const BoxReplayOptions&);
template Totals totals_of(const BoxReplayResult&, const BoxTrace<double>&, const BoxReplayOptions&);

}  // namespace bvlab
