// SPDX-License-Identifier: BSD-3-Clause
/// Time-critical answers: what is known after a given number of volume tests for each pair and
/// frame, how deep the rest can be at most, and what it cost; every volume on the same traces.
/// Beside it the volume's own full answer, from which those given early must not differ.
#include <algorithm>
#include <random>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay_budgeted.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/wandering.hpp"

namespace bvlab {
namespace {

StudyParameters parameters() {
  return with_wandering_and_side({wholes_parameter("budgets", {1, 10, 100, 1000}, {0, 1e9},
                                                   "volume tests for each pair and frame")});
}

void run(const StudyDefinition& definition, const std::filesystem::path& folder,
         const Progress& progress) {
  const Wandering wandering(definition, definition.number("side"));
  const auto budgets = definition.wholes("budgets");
  StudyRecord record(
      definition, folder,
      {"mesh", "volume", "budget", "repetition", "answers", "touching", "apart", "unknown", "wrong",
       "mean_deepest_per_radius", "deepest_per_radius", "n_u", "n_v", "n_p", "time_ns"},
      1, progress);
  std::mt19937_64 random(20260101);
  std::size_t done = 0;
  for (const auto& name : wandering.names) {
    if (record.has({name})) {
      record.save(++done, wandering.names.size());
      continue;
    }
    const auto [meshes, trace, radius] = wandering.scene(name);
    const auto truth = replay(meshes, trace, Variant{}, {}).touching;

    struct Cell {
      std::string volume;
      std::uint64_t budget;
      BudgetedResult counted;
    };
    std::vector<Cell> cells;
    for (const auto budget : budgets)
      for (const auto& volume : volumes()) {
        Variant variant;
        variant.volume = volume.name;
        cells.push_back(
            {variant.volume, budget, replay_budgeted(meshes, trace, variant, budget, Count::on)});
      }
    for (unsigned repetition = 0; repetition < definition.repetitions; ++repetition) {
      std::shuffle(cells.begin(), cells.end(), random);
      for (const auto& [volume, budget, counted] : cells) {
        Variant variant;
        variant.volume = volume;
        const auto timed = replay_budgeted(meshes, trace, variant, budget, Count::off);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < truth.size(); ++i)
          wrong += timed.known[i] != 2 && timed.known[i] != truth[i];
        Row row{name, volume};
        for (const std::uint64_t n :
             {budget, std::uint64_t{repetition}, std::uint64_t{truth.size()}, timed.touching,
              timed.apart, timed.unknown, std::uint64_t{wrong}})
          row.push_back(std::to_string(n));
        row.push_back(text_of(timed.mean_deepest / radius));
        row.push_back(text_of(timed.deepest / radius));
        for (const std::uint64_t n : {counted.n_u, counted.n_v, counted.n_p})
          row.push_back(std::to_string(n));
        row.push_back(text_of(std::round(timed.seconds * 1e9)));
        record.add(std::move(row));
      }
    }
    record.save(++done, wandering.names.size());
  }
}

}  // namespace

const StudyKind studies::budget = {
    "budget", "what is known after a given number of tests, and how deep the rest can be",
    parameters, nullptr, run};

}  // namespace bvlab
