// SPDX-License-Identifier: BSD-3-Clause
/// The stability map: false answers to "do they touch" of every volume, strategy and precision, and
/// of every peer, under every stressor; and of the configurations with names. The truth is found by
/// brute force in rational numbers.
#include <unistd.h>

#include "experiments/files/guarded.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/studies/stressors.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

using Answers = std::vector<std::uint8_t>;

StudyParameters parameters() {
  return {one(wholes_parameter("frames", {100}, {1, 1e6}, "placements of each stressor")),
          one(wholes_parameter("seed", {1}, seeds, "of the random numbers")),
          one(wholes_parameter("seconds", {20}, {1, 3600}, "for each peer under each stressor"))};
}

/// What a peer answers, in a process of its own; nothing where it crashed, refused, or took longer
/// than `seconds`: what other libraries do with such input is not to end ours.
std::optional<Answers> answers_of(const Peer& peer, const StressCase& stress, unsigned seconds) {
  constexpr std::size_t any_memory = std::size_t{1} << 46;
  const Guarded found = guarded({seconds, any_memory}, [&] {
    alarm(seconds);  // also where it waits
    const auto answers = peer.replay(stress.meshes, stress.trace, "touching", {}).touching;
    return std::string(answers.begin(), answers.end());
  });
  if (found.signal != 0 || found.bytes.size() != stress.trace.frames) return {};
  return Answers(found.bytes.begin(), found.bytes.end());
}

/// Compares answers under one stressor with the truth, a row for each who answers.
class Judge {
 public:
  Judge(const StressCase& stress, StudyRecord& record)
      : stress_(stress), record_(record), truth_(truth_of(stress)) {}

  void ours(const Variant& variant, const std::string& configuration) {
    const Variant& v = variant;
    add(replay(stress_.meshes, stress_.trace, v, {}).touching, "bvlab", v.volume, v.strategy,
        v.precision, v.fan_out, v.frame, v.kernel, configuration);
  }
  void theirs(unsigned seconds) {
    for (const Peer& peer : peers()) {
      if (!peer.answers("touching") || peer.takes_solids) continue;
      add(answers_of(peer, stress_, seconds), std::string(peer.name), "", "", "", "", "", "", "");
    }
  }

 private:
  /// `who`: from `source` to `configuration`.
  template <class... Who>
  void add(const std::optional<Answers>& answers, const Who&... who) {
    std::size_t touching = 0, positives = 0, negatives = 0;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      touching += truth_[i];
      if (!answers) continue;
      positives += (*answers)[i] > truth_[i], negatives += (*answers)[i] < truth_[i];
    }
    const auto count = [&](std::size_t n) { return answers ? text_of(n) : ""; };
    record_.add(who..., answers ? truth_.size() : 0, touching, count(positives), count(negatives));
  }

  const StressCase& stress_;
  StudyRecord& record_;
  const Answers truth_;
};

void run(const StudyDefinition& definition, StudyRecord& record) {
  std::vector<std::pair<const Stressor*, double>> cases;
  for (const auto& stressor : stressors())
    for (const double level : stressor.levels) cases.emplace_back(&stressor, level);
  const auto key_of = [](const auto& each) {
    return Row{std::string(each.first->name), text_of(each.second)};
  };
  record.each(cases, key_of, [&](const auto& each) {
    const StressCase stress =
        each.first->make(each.second, definition.whole("frames"), definition.whole("seed"));
    Judge judge(stress, record);
    for (const auto& variant : stressed_variants()) judge.ours(variant, "");
    for (const auto& [name, what] : configurations()) judge.ours(configured({}, name), name);
    judge.theirs(static_cast<unsigned>(definition.whole("seconds")));
  });
}

}  // namespace

const StudyKind studies::stability = {
    "stability",
    "false answers of every variant and peer under every stressor",
    parameters,
    nullptr,
    {"stressor", "level", "source", "volume", "strategy", "precision", "fan_out", "frame", "kernel",
     "configuration", "answers", "touching", "false_positives", "false_negatives"},
    run};

}  // namespace bvlab
