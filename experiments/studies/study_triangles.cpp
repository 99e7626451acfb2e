// SPDX-License-Identifier: BSD-3-Clause
/// Misclassified pairs of triangles and time per call: every precision, one by one and batched, and
/// every other test, on sets from harmless to nasty. The truth is CGAL's, in rational numbers.
#include <time.h>

#include <algorithm>

#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/peers/triangle_tests.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "experiments/scenes/triangle_sets.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

using Pairs = TriangleTestPeer::Pairs;

template <class Precision>
void one_by_one(Pairs pairs, std::uint8_t* verdicts) {
  for (const auto& [a, b] : pairs) *verdicts++ = intersect<Precision>(a, b);
}

template <class Precision>
void batched(Pairs pairs, std::uint8_t* verdicts) {
  constexpr std::size_t most = 16;  // as queries do
  for (std::size_t first = 0; first < pairs.size(); first += most) {
    const std::size_t count = std::min(most, pairs.size() - first);
    const Triangle *a[most], *b[most];
    for (std::size_t i = 0; i < count; ++i)
      a[i] = &pairs[first + i][0], b[i] = &pairs[first + i][1];
    const std::uint64_t hits = intersect_batch<Precision>(a, b, static_cast<int>(count));
    for (std::size_t i = 0; i < count; ++i) *verdicts++ = hits >> i & 1;
  }
}

struct Test {
  std::string name, source;
  void (*decide)(Pairs, std::uint8_t*);
  bool takes_zero_area = true;
};

std::vector<Test> all_tests() {
  std::vector<Test> tests;
  Precisions::for_each([&]<class Precision>(std::type_identity<Precision>) {
    tests.push_back({std::string(Precision::name), "batched", batched<Precision>});
    tests.push_back({std::string(Precision::name), "one by one", one_by_one<Precision>});
  });
  for (const auto& peer : triangle_test_peers())
    tests.push_back({std::string(peer.name), "peer", peer.decide, peer.takes_zero_area});
  return tests;
}

StudyParameters parameters() {
  std::vector<std::string> sets;
  for (const auto& set : triangle_sets) sets.emplace_back(set.name);
  return {words_parameter("sets", sets, "of pairs of triangles", sets),
          one(wholes_parameter("pairs", {50000}, {1, 1e7}, "pairs in each set")),
          one(wholes_parameter("at_once", {5000}, {1, 1e7}, "pairs that are timed together")),
          one(wholes_parameter("seed", {1}, seeds, "of the random numbers"))};
}

/// Pairs with area, so that every test can answer, but for the sets that are made of others.
std::vector<TrianglePair> pairs_of(const std::string& name, const StudyDefinition& definition,
                                   bool zero_area) {
  const auto set = std::find_if(std::begin(triangle_sets), std::end(triangle_sets),
                                [&](const TriangleSet& each) { return each.name == name; });
  auto pairs = set->make(definition.whole("pairs"), definition.whole("seed"));
  if (!zero_area)
    std::erase_if(pairs, [](const TrianglePair& pair) {
      return oracle::without_area(pair[0]) || oracle::without_area(pair[1]);
    });
  return pairs;
}

/// Of this thread on a processor: neighbours on the machine disturb that less than the wall clock.
double thread_nanoseconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

void run(const StudyDefinition& definition, StudyRecord& record) {
  const std::size_t at_once = definition.whole("at_once");
  const std::vector<Test> tests = all_tests();
  record.each(definition.words("sets"), [&](const std::string& set) {
    const bool zero_area = set.starts_with("without area");
    const auto pairs = pairs_of(set, definition, zero_area);
    std::vector<std::uint8_t> truth, verdicts(pairs.size());
    for (const auto& [a, b] : pairs) truth.push_back(oracle::intersect(a, b));
    record.interleave(tests.size(), [&](std::size_t k, unsigned repetition) {
      const Test& test = tests[k];
      if (zero_area && !test.takes_zero_area) return;
      // Pairs few enough to stay in the cache: once to bring them there, then by the clock.
      double time = 0;
      for (std::size_t first = 0; first < pairs.size(); first += at_once) {
        const Pairs some(&pairs[first], std::min(at_once, pairs.size() - first));
        if (first == 0) test.decide(some, &verdicts[first]);
        const double start = thread_nanoseconds();
        test.decide(some, &verdicts[first]);
        time += thread_nanoseconds() - start;
      }
      std::size_t touching = 0, positives = 0, negatives = 0;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        touching += truth[i];
        positives += verdicts[i] > truth[i], negatives += verdicts[i] < truth[i];
      }
      record.add(test.name, test.source, repetition, pairs.size(), touching, positives, negatives,
                 time / static_cast<double>(pairs.size()));
    });
  });
}

}  // namespace

const StudyKind studies::triangles = {
    "triangles",
    "misclassified pairs and time of every triangle test on every set",
    parameters,
    nullptr,
    {"set", "test", "source", "repetition", "pairs", "touching", "false_positives",
     "false_negatives", "ns_per_call"},
    run};

}  // namespace bvlab
