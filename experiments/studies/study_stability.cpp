// SPDX-License-Identifier: BSD-3-Clause
/// The stability map: false answers to "do they touch" of every volume, strategy and precision, and
/// of every peer, under every stressor; and of the configurations with names. The truth is found by
/// brute force in rational numbers.
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/studies/stressors.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

using Answers = std::vector<std::uint8_t>;

struct Settings {
  std::size_t frames;
  std::uint64_t seed;
  int seconds;
};

StudyParameters parameters() {
  return {whole_parameter("frames", 100, {1, 1e6}, "placements of each stressor"),
          whole_parameter("seed", 1, seeds, "of the random numbers"),
          whole_parameter("seconds", 20, {1, 3600}, "for each peer under each stressor")};
}

Settings settings_of(const StudyDefinition& definition) {
  return {definition.whole("frames"), definition.whole("seed"),
          static_cast<int>(definition.whole("seconds"))};
}

/// What `work` answers in a process of its own; nothing where it crashed, refused, or took longer
/// than `seconds`: what other libraries do with such input is not to end ours.
template <class Work>
std::optional<Answers> in_a_child(std::size_t count, int seconds, const Work& work) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    close(ends[0]);
    try {
      const Answers answers = work();
      std::size_t sent = 0;
      while (sent < answers.size()) {
        const auto n = write(ends[1], answers.data() + sent, answers.size() - sent);
        if (n <= 0) _exit(1);
        sent += static_cast<std::size_t>(n);
      }
    } catch (...) {
      _exit(1);
    }
    _exit(0);
  }
  close(ends[1]);
  Answers answers(count);
  std::size_t got = 0;
  pollfd ready{ends[0], POLLIN, 0};
  while (got < count && poll(&ready, 1, seconds * 1000) > 0) {
    const auto n = read(ends[0], answers.data() + got, count - got);
    if (n <= 0) break;
    got += static_cast<std::size_t>(n);
  }
  close(ends[0]);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  if (got < count) return {};
  return answers;
}

class Map {
 public:
  Map(const StudyDefinition& definition, StudyRecord& record)
      : settings_(settings_of(definition)), record_(record) {}

  void run() {
    std::vector<std::pair<const Stressor*, double>> cases;
    for (const auto& stressor : stressors())
      for (const double level : stressor.levels) cases.emplace_back(&stressor, level);
    const auto key_of = [](const auto& each) {
      return Row{std::string(each.first->name), text_of(each.second)};
    };
    record_.each(cases, key_of, [&](const auto& each) {
      key_ = key_of(each);
      const StressCase stress = each.first->make(each.second, settings_.frames, settings_.seed);
      truth_ = truth_of(stress);
      ours(stress);
      theirs(stress);
    });
  }

 private:
  void ours(const StressCase& stress) {
    for (const auto& variant : stressed_variants()) add(stress, variant, "");
    for (const auto& configuration : configurations())
      add(stress, configured({}, configuration.name, stress.meshes, &stress.trace).variant,
          std::string(configuration.name));
  }
  void add(const StressCase& stress, const Variant& variant, const std::string& configuration) {
    add({"bvlab", variant.volume, variant.strategy, variant.precision,
         std::to_string(variant.fan_out), variant.frame, variant.kernel, configuration},
        replay(stress.meshes, stress.trace, variant, {}).touching);
  }

  void theirs(const StressCase& stress) {
    for (const Peer& peer : peers()) {
      if (!peer.answers("touching") || peer.takes_solids) continue;
      Row of_peer(8);
      of_peer[0] = peer.name;
      add(std::move(of_peer), in_a_child(settings_.frames, settings_.seconds, [&] {
            return peer.replay(stress.meshes, stress.trace, "touching", {}).touching;
          }));
    }
  }

  /// `row`: from `source` to `configuration`.
  void add(Row row, const std::optional<Answers>& answers) {
    std::size_t touching = 0, positives = 0, negatives = 0;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      touching += truth_[i];
      if (!answers) continue;
      positives += (*answers)[i] > truth_[i], negatives += (*answers)[i] < truth_[i];
    }
    const auto count = [&](std::size_t n) { return answers ? std::to_string(n) : std::string(); };
    row.insert(row.begin(), key_.begin(), key_.end());
    for (const auto& field : {std::to_string(answers ? truth_.size() : 0), std::to_string(touching),
                              count(positives), count(negatives)})
      row.push_back(field);
    record_.add(std::move(row));
  }

  Settings settings_;
  StudyRecord& record_;
  Row key_;
  Answers truth_;
};

void run(const StudyDefinition& definition, StudyRecord& record) { Map(definition, record).run(); }

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
