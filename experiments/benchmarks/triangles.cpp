// SPDX-License-Identifier: BSD-3-Clause
/// Nanoseconds a call of the triangle test: every set, every precision, one by one and batched,
/// and the peers. `touching` beside a time is the answer: what differs from `exact` is wrong.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "experiments/peers/triangle_tests.hpp"
#include "experiments/scenes/triangle_sets.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

using Pairs = std::span<const TrianglePair>;

template <class Precision>
std::size_t count_one_by_one(Pairs pairs) {
  std::size_t touching = 0;
  for (const auto& [a, b] : pairs) touching += intersect<Precision>(a, b);
  return touching;
}

template <class Precision>
std::size_t count_batched(Pairs pairs) {
  constexpr std::size_t most = 16;
  std::size_t touching = 0;
  for (std::size_t first = 0; first < pairs.size(); first += most) {
    const std::size_t count = std::min(most, pairs.size() - first);
    const Triangle *a[most], *b[most];
    for (std::size_t i = 0; i < count; ++i)
      a[i] = &pairs[first + i][0], b[i] = &pairs[first + i][1];
    touching += std::popcount(intersect_batch<Precision>(a, b, static_cast<int>(count)));
  }
  return touching;
}

/// Few enough to stay in the second cache, too many for the branch predictor to learn by heart.
constexpr std::size_t pairs_per_set = 8192;

void measure(const std::string& test, const TriangleSet& set,
             const std::function<std::size_t(Pairs)>& count) {
  benchmark::RegisterBenchmark((test + "/" + std::string(set.name)).c_str(), [=](benchmark::State&
                                                                                     state) {
    const auto pairs = set.make(pairs_per_set, 7);
    std::size_t touching = 0;
    for (auto _ : state) benchmark::DoNotOptimize(touching = count(pairs));
    state.counters["touching"] = static_cast<double>(touching);
    state.counters["s_per_call"] = benchmark::Counter(
        static_cast<double>(pairs_per_set),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  })->Unit(benchmark::kMicrosecond);
}

template <class Precision>
void measure(const TriangleSet& set) {
  measure(std::string(Precision::name), set, count_one_by_one<Precision>);
  measure(std::string(Precision::name) + " batched", set, count_batched<Precision>);
}

}  // namespace
}  // namespace bvlab

int main(int argc, char** argv) {
  using namespace bvlab;
  for (const TriangleSet& set : triangle_sets) {
    Precisions::for_each(
        [&]<class Precision>(std::type_identity<Precision>) { measure<Precision>(set); });
    for (const auto& peer : triangle_test_peers()) {
      // What another library asserts about its input it may abort on: no triangles without area.
      if (!peer.takes_zero_area && (set.name.starts_with("without area") || set.name == "slivers"))
        continue;
      measure(std::string(peer.name), set, [decide = peer.decide](Pairs pairs) {
        static std::vector<std::uint8_t> verdicts;
        verdicts.resize(pairs.size());
        decide(pairs, verdicts.data());
        return static_cast<std::size_t>(std::count(verdicts.begin(), verdicts.end(), 1));
      });
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
