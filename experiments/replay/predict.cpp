// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/predict.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "experiments/replay/registry.hpp"
#include "traversal/strategies/adaptive.hpp"
#include "traversal/strategies/by_cost.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/raise.hpp"
#include "traversal/strategies/recursive.hpp"
#include "traversal/strategies/separation_list.hpp"

namespace bvlab {
namespace {

/// Some frames of a run that began with the first of them.
struct Window {
  std::size_t first = 0;
  std::vector<double> volumes, triangles, seconds;  // of each frame

  std::size_t size() const { return volumes.size(); }
};
using Tests = std::vector<double> Window::*;

/// Where windows begin: alike far from each other.
std::vector<std::size_t> window_starts(std::size_t frames, std::size_t stride) {
  const std::size_t count = std::max<std::size_t>((frames + stride / 2) / stride, 1);
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < count; ++k) starts.push_back(k * frames / count);
  return starts;
}

Trace part_of(const Trace& trace, std::size_t first, std::size_t frames) {
  const auto place = [&](std::size_t frame) {
    return trace.values.begin() + static_cast<std::ptrdiff_t>(frame * trace.objects * 7);
  };
  return {frames, trace.objects, {place(first), place(first + frames)}};
}

/// Plays strategies over parts of a trace; hierarchies are built once.
class Player {
 public:
  Player(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant)
      : trace_(trace),
        variant_(variant),
        volume_(volume_entry(variant.volume)),
        hierarchies_(volume_.hierarchies(meshes, variant)) {}

  Window play(std::string_view strategy, std::size_t first, std::size_t frames) const {
    Variant variant = variant_;
    variant.strategy = strategy;
    ReplayOptions options;
    options.count = Count::on;
    options.keep_answers = false;
    options.keep_series = options.keep_frame_seconds = true;
    ReplayResult result;
    play_entry(strategy, variant.query)
        .play(volume_, *hierarchies_, part_of(trace_, first, frames), variant, options, result);
    Window window{first, {}, {}, std::move(result.frame_seconds)};
    for (const FrameCounts& counts : result.series) {
      window.volumes.push_back(static_cast<double>(counts.n_v));
      window.triangles.push_back(static_cast<double>(counts.n_p));
    }
    return window;
  }

 private:
  const Trace& trace_;
  const Variant& variant_;
  const VolumeEntry& volume_;
  std::unique_ptr<AnyHierarchies> hierarchies_;
};

/// Tests of a strategy and of recursion in the same frame.
struct Sampled {
  double tests, recursion;
};

/// What a strategy makes in the frames from `first` on, from what it made in some others.
double settled(std::span<const Sampled> some, std::span<const double> recursion,
               std::size_t first) {
  if (some.empty() || first >= recursion.size()) return 0;
  const auto count = static_cast<double>(some.size());
  double mean = 0, of_recursion = 0;
  for (const Sampled& each : some)
    mean += each.tests / count, of_recursion += each.recursion / count;
  double together = 0, alone = 0;
  for (const Sampled& each : some) {
    together += (each.tests - mean) * (each.recursion - of_recursion);
    alone += (each.recursion - of_recursion) * (each.recursion - of_recursion);
  }
  const double steepest = of_recursion > 0 ? mean / of_recursion : 0;
  const double slope = alone > 0 ? std::clamp(together / alone, 0.0, steepest) : 0;
  double sum = 0;
  for (std::size_t frame = first; frame < recursion.size(); ++frame)
    sum += mean + slope * (recursion[frame] - of_recursion);
  return std::max(sum, 0.0);
}

/// Of all frames of the trace, in which recursion is known.
double extended(std::span<const Window> windows, const Window& recursion, Tests tests,
                std::size_t length) {
  const std::vector<double>& known = recursion.*tests;
  std::vector<Sampled> ages(std::min(length, known.size()), {0, 0}), old;
  std::vector<double> seen(ages.size());
  for (const Window& window : windows)
    for (std::size_t age = 0; age < window.size(); ++age) {
      const Sampled sampled{(window.*tests)[age], known[window.first + age]};
      ages[age].tests += sampled.tests, ages[age].recursion += sampled.recursion;
      seen[age] += 1;
      if (age >= length / 2) old.push_back(sampled);
    }
  double sum = settled(old, known, ages.size());
  for (std::size_t age = 0; age < ages.size(); ++age) {
    const auto [made, beside] = ages[age];
    if (beside > 0)
      sum += made / beside * known[age];
    else if (seen[age] > 0)
      sum += made / seen[age];
  }
  return sum;
}

double price(const Adaptive::Prices& prices, double runs, double volumes, double triangles) {
  return 1e-9 * (prices.run * runs + prices.volumes * volumes + prices.triangles * triangles);
}

/// How many times what the prices say a frame took: the median, weighted by that.
double dearness(std::span<const Window> windows, const Adaptive::Prices& prices, double pairs) {
  std::vector<std::pair<double, double>> frames;
  double all = 0;
  for (const Window& window : windows)
    for (std::size_t k = 0; k < window.size(); ++k) {
      const double said = price(prices, pairs, window.volumes[k], window.triangles[k]);
      if (said > 0) frames.emplace_back(window.seconds[k] / said, said), all += said;
    }
  std::sort(frames.begin(), frames.end());
  double so_far = 0;
  for (const auto& [times, said] : frames)
    if ((so_far += said) >= all / 2) return times;
  return 1;
}

struct Priced {
  std::string_view strategy;
  Adaptive::Prices prices;
};

/// All but recursion.
constexpr Priced others[] = {
    {RecursiveBoth::name, Adaptive::broad}, {SeparationList::name, Adaptive::plain},
    {Deferred::name, Adaptive::plain},      {ByCost::name, Adaptive::plain},
    {Raise::name, Adaptive::plain},         {Margins::name, Adaptive::careful}};

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

}  // namespace

std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, const PredictOptions& options) {
  check(variant);
  if (trace.frames == 0) {
    std::vector<Predicted> nothing{{Recursive::name}};
    for (const Priced& each : others) nothing.push_back({each.strategy});
    return nothing;
  }
  const Player player(meshes, trace, variant);
  const auto pairs = static_cast<double>(trace.pairs());
  const auto predicted = [&](const Priced& of, std::span<const Window> windows, double volumes,
                             double triangles) {
    const double runs = pairs * static_cast<double>(trace.frames);
    return Predicted{
        of.strategy, volumes, triangles,
        price(of.prices, runs, volumes, triangles) * dearness(windows, of.prices, pairs)};
  };
  const Window recursion = player.play(Recursive::name, 0, trace.frames);
  std::vector<Predicted> all{predicted({Recursive::name, Adaptive::broad}, {&recursion, 1},
                                       sum_of(recursion.volumes), sum_of(recursion.triangles))};
  for (const Priced& of : others) {
    std::vector<Window> windows;
    for (const std::size_t first : window_starts(trace.frames, options.stride))
      windows.push_back(
          player.play(of.strategy, first, std::min(options.window, trace.frames - first)));
    all.push_back(predicted(of, windows,
                            extended(windows, recursion, &Window::volumes, options.window),
                            extended(windows, recursion, &Window::triangles, options.window)));
  }
  return all;
}

std::string_view fastest(std::span<const Predicted> predicted) {
  const auto least = std::min_element(
      predicted.begin(), predicted.end(),
      [](const Predicted& a, const Predicted& b) { return a.seconds < b.seconds; });
  return least == predicted.end() ? std::string_view() : least->strategy;
}

}  // namespace bvlab
