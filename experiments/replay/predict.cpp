// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/predict.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <utility>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "traversal/strategies/adaptive.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab {
namespace {

using Clock = std::chrono::steady_clock;

/// Some frames of a run that began with the first of them.
struct Window {
  std::size_t first = 0;
  std::vector<double> volumes, triangles, seconds;  // of each frame

  std::size_t size() const { return volumes.size(); }
};
using Tests = std::vector<double> Window::*;

/// Where windows begin: the first with the trace, each of the others anywhere in its part, the same
/// every time.
std::vector<std::size_t> window_starts(std::size_t frames, const PredictOptions& options) {
  const std::size_t count =
      std::max<std::size_t>((frames + options.stride / 2) / options.stride, 1);
  std::mt19937 random(count);
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k * frames / count, end = (k + 1) * frames / count;
    const std::size_t room = end - first > options.window ? end - first - options.window : 0;
    starts.push_back(first + (k > 0 ? random() % (room + 1) : 0));
  }
  return starts;
}

/// Plays strategies over parts of a trace; hierarchies are built once.
class Player {
 public:
  Player(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
         const std::function<void()>& waiting)
      : meshes_(meshes),
        trace_(trace),
        variant_(variant),
        waiting_(waiting),
        from_(std::make_shared<PairsFrom>(meshes, trace.objects, 1)) {}

  Window play(std::string_view strategy, std::size_t first, std::size_t frames) const {
    Variant variant = variant_;
    variant.strategy = strategy;
    std::vector<std::size_t> played_frames(frames);
    std::iota(played_frames.begin(), played_frames.end(), first);
    const Trace part = part_of(trace_, played_frames);
    Window window{first, {}, {}, timed(variant, part)};
    ReplayOptions options;
    options.count = Count::on;
    options.keep_answers = false;
    options.keep_series = true;
    options.after_frame = [&](std::size_t) { waiting_(); };
    const ReplayResult counted = replay(from_, part, variant, options);
    for (const FrameCounts& counts : counted.series) {
      window.volumes.push_back(static_cast<double>(counts.n_v));
      window.triangles.push_back(static_cast<double>(counts.n_p));
    }
    return window;
  }

 private:
  /// Seconds of each frame, those of a few together dealt out evenly: the clock is not free.
  std::vector<double> timed(const Variant& variant, const Trace& part) const {
    const std::size_t few = std::max<std::size_t>(part.frames / 8, 1);
    std::vector<Clock::time_point> read;
    ReplayOptions options;
    options.keep_answers = false;
    options.after_frame = [&](std::size_t frame) {
      if ((frame + 1) % few == 0 || frame + 1 == part.frames) read.push_back(Clock::now());
      waiting_();
    };
    const ReplayResult result = replay(from_, part, variant, options);
    std::vector<double> seconds(part.frames);
    double later = 0;
    for (std::size_t k = read.size(); k-- > 0;) {
      const std::size_t begin = k * few, end = std::min(begin + few, part.frames);
      const double took = k > 0 ? std::chrono::duration<double>(read[k] - read[k - 1]).count()
                                : std::max(result.seconds - later, 0.0);
      later += took;
      std::fill(seconds.begin() + static_cast<std::ptrdiff_t>(begin),
                seconds.begin() + static_cast<std::ptrdiff_t>(end),
                took / static_cast<double>(end - begin));
    }
    return seconds;
  }

  std::span<const TriangleMesh> meshes_;
  const Trace& trace_;
  const Variant& variant_;
  const std::function<void()>& waiting_;
  std::shared_ptr<PairsFrom> from_;  // its trees are made once
};

/// What a strategy made, tests or seconds, and recursion beside it in the same frame.
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

/// Of all frames of the trace, in which what recursion made is known: tests of the same kind, or
/// what they cost.
double extended(std::span<const Window> windows, std::span<const double> known, Tests tests,
                std::size_t length) {
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

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

/// The relative half of an interval of 95 %, from estimates that each left out one part.
double jackknife(const std::vector<double>& estimates, double estimate) {
  constexpr double student[] = {12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23};
  const std::size_t count = estimates.size();
  if (count < 2 || estimate <= 0) return 0;
  const double mean = sum_of(estimates) / static_cast<double>(count);
  double squares = 0;
  for (const double each : estimates) squares += (each - mean) * (each - mean);
  const double error =
      std::sqrt(squares * static_cast<double>(count - 1) / static_cast<double>(count));
  return (count - 2 < std::size(student) ? student[count - 2] : 2.0) * error / estimate;
}

/// By how much of itself the time of windows still changed between the quarters of their second
/// halves.
double drift(std::span<const Window> windows, std::size_t length) {
  double earlier = 0, later = 0;
  for (const Window& window : windows)
    for (std::size_t age = length / 2; age < window.size(); ++age)
      (age < length / 2 + length / 4 ? earlier : later) += window.seconds[age];
  return earlier > 0 ? std::abs(later - earlier) / earlier : 0;
}

/// Recursion in every frame, and what its tests cost there.
struct Baseline {
  Window recursion;
  std::vector<double> price;

  Baseline(Window all, double pairs) : recursion(std::move(all)) {
    constexpr Adaptive::Prices prices = Adaptive::of_recursion;
    for (std::size_t k = 0; k < recursion.size(); ++k)
      price.push_back(prices.run * pairs + prices.volumes * recursion.volumes[k] +
                      prices.triangles * recursion.triangles[k]);
  }
  std::size_t frames() const { return recursion.size(); }
};

/// The frames that no window covers, as a part of all.
double uncovered(std::span<const Window> windows, std::size_t frames) {
  double covered = 0;
  for (const Window& window : windows) covered += static_cast<double>(window.size());
  return std::max(0.0, 1 - covered / static_cast<double>(frames));
}

/// One strategy's prediction from its windows of that length.
Predicted predicted(std::string_view strategy, const std::vector<Window>& windows,
                    const Baseline& known, std::size_t length) {
  const auto seconds = [&](std::span<const Window> some) {
    return extended(some, known.price, &Window::seconds, length);
  };
  Predicted told{strategy};
  told.n_v = extended(windows, known.recursion.volumes, &Window::volumes, length);
  told.n_p = extended(windows, known.recursion.triangles, &Window::triangles, length);
  told.seconds = seconds(windows);
  told.windows = windows.size();
  told.is_played = windows.size() == 1 && windows[0].size() == known.frames();
  std::vector<double> left_out;
  for (std::size_t k = 0; k < windows.size() && windows.size() > 1; ++k) {
    std::vector<Window> rest = windows;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    left_out.push_back(seconds(rest));
  }
  constexpr double least = 0.2;
  double half = least + jackknife(left_out, told.seconds);
  if (!told.is_played) half += uncovered(windows, known.frames()) * drift(windows, length);
  told.low = told.seconds * std::max(0.0, 1 - half), told.high = told.seconds * (1 + half);
  return told;
}

/// Names of all strategies, recursion the first. Throws Unusable where that is not among them.
std::vector<std::string_view> strategies_for(std::string_view query) {
  std::vector<std::string_view> names;
  for (const PlayEntry* entry : play_entries())
    if (entry->query == query) names.push_back(entry->strategy);
  const auto recursive = std::find(names.begin(), names.end(), Recursive::name);
  if (recursive == names.end())
    throw Unusable("predict", "needs the strategy " + std::string(Recursive::name) +
                                  ", which was not compiled");
  std::rotate(names.begin(), recursive, recursive + 1);
  return names;
}

}  // namespace

PredictOptions options_for(std::size_t frames) {
  PredictOptions options;
  if (frames < least_windows * options.stride)
    options.stride = options.window = std::max<std::size_t>(frames, 2);
  return options;
}

std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant) {
  return predict(meshes, trace, variant, options_for(trace.frames));
}

std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, const PredictOptions& options) {
  check(variant);
  if (variant.kernel != Variant{}.kernel)
    throw Unusable("--kernel " + variant.kernel,
                   "only " + Variant{}.kernel + " is predicted, which every strategy has");
  std::vector<Predicted> all;
  const auto names = strategies_for(variant.query);
  if (trace.frames == 0) {
    for (const auto name : names) all.push_back({name});
    return all;
  }
  const Player player(meshes, trace, variant, options.waiting);
  const Baseline known(player.play(Recursive::name, 0, trace.frames),
                       static_cast<double>(trace.pairs()));
  all.push_back(predicted(Recursive::name, {known.recursion}, known, trace.frames));
  const auto starts = window_starts(trace.frames, options);
  for (std::size_t i = 1; i < names.size(); ++i) {
    std::vector<Window> windows;
    for (const std::size_t first : starts)
      windows.push_back(
          player.play(names[i], first, std::min(options.window, trace.frames - first)));
    all.push_back(predicted(names[i], windows, known, options.window));
  }
  if (!nothing_to_tell(trace).empty())
    for (Predicted& each : all) each.windows = 0, each.is_played = false;
  return all;
}

std::string_view nothing_to_tell(const Trace& trace) {
  if (trace.frames == 0) return "there are no frames";
  if (trace.pairs() == 0) return "there are no pairs of bodies";
  if (trace.frames == 1) return "of one frame, every strategy starts from the roots";
  return {};
}

bool can_tell(std::span<const Predicted> predicted) {
  return !predicted.empty() &&
         std::all_of(predicted.begin(), predicted.end(), [](const Predicted& each) {
           return each.is_played || each.windows >= least_windows;
         });
}

std::vector<std::string_view> candidates(std::span<const Predicted> predicted) {
  std::vector<Predicted> sorted(predicted.begin(), predicted.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Predicted& a, const Predicted& b) { return a.seconds < b.seconds; });
  std::vector<std::string_view> names;
  for (const Predicted& each : sorted)
    if (!can_tell(predicted) || each.low <= sorted[0].high) names.push_back(each.strategy);
  return names;
}

}  // namespace bvlab
