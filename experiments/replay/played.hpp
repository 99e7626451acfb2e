// SPDX-License-Identifier: BSD-3-Clause
/// Replays and whole scenes over pairs of any kind, compiled once for each query (played.cpp.in).
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "experiments/replay/pairs_in_turn.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/query_entry.hpp"
#include "experiments/replay/touching_world.hpp"
#include "experiments/replay/trace_pairs.hpp"
#include "experiments/replay/triangle_test.hpp"

namespace bvlab::detail {

inline QueryOptions query_options(const Variant& variant) {
  return {triangle_test(variant.precision), variant.relative_error};
}

inline bool counts(const ReplayOptions& options) {
  return options.count == Count::on || options.keep_series;
}

template <class Query>
class PlayedBy final : public Player {
 public:
  PlayedBy(std::unique_ptr<AnyPairs<Query>> pairs, std::span<const TriangleMesh> meshes,
           const Trace& trace, const Variant& variant, const ReplayOptions& options,
           ReplayResult& result)
      : result_(result),
        options_(options),
        engine_(PairsAsked<Query>(std::move(pairs)), trace,
                uses_broad_phase<Query>(trace, options) ? BroadPhase::on : BroadPhase::off,
                static_cast<int>(options.threads)),
        answers_(result, meshes, trace, options, query_options(variant)),
        poses_(trace) {}

  void play(std::size_t frame) override {
    const std::span<const Pose> poses = poses_.at(frame);
    answers_.begin_frame(frame, poses);
    engine_.frame(poses, counter_, answers_);
    auto& pairs = engine_.pairs();
    if (counts(options_)) pairs.count_posed(counter_);
    const std::size_t front = pairs.front_size();
    result_.front += static_cast<double>(front);
    if (options_.keep_series)
      result_.series.push_back({counter_.n_u, counter_.n_v, counter_.n_p, front, answers_.hits()});
    if (const auto near = engine_.near()) result_.near = result_.near.value_or(0) + *near;
    if (options_.see_front)
      pairs.see_fronts([&](std::size_t p, std::span<const NodePair> entries) {
        options_.see_front(frame, p, entries);
      });
  }

  void finish() override {
    result_.hits += answers_.hits();
    const auto [nodes, made] = engine_.pairs().nodes();
    result_.nodes += nodes, result_.nodes_made += made;
    if (const auto choice = engine_.pairs().choice()) {
      result_.chosen = choice->reason;
      result_.build_seconds += choice->build_seconds;
      result_.choosing_seconds += choice->choosing_seconds;
      result_.seconds -= choice->build_seconds + choice->choosing_seconds;
    }
    if (!counts(options_)) return;
    result_.n_b += counter_.n_b, result_.n_u += counter_.n_u, result_.n_v += counter_.n_v;
    result_.n_p += counter_.n_p, result_.considered += counter_.considered;
  }

 private:
  ReplayResult& result_;
  const ReplayOptions& options_;
  TracePairs<Query> engine_;
  Answers<Query> answers_;
  PosesInTurn poses_;
  Counting counter_;
};

/// All must outlive the player.
template <class Query>
std::unique_ptr<Player> player_over(std::unique_ptr<AnyPairs<Query>> pairs,
                                    std::span<const TriangleMesh> meshes, const Trace& trace,
                                    const Variant& variant, const ReplayOptions& options,
                                    ReplayResult& result) {
  return std::make_unique<PlayedBy<Query>>(std::move(pairs), meshes, trace, variant, options,
                                           result);
}

template <class Query>
std::unique_ptr<AnyPairs<Query>> under(std::unique_ptr<PairsUnderSome> pairs) {
  return std::unique_ptr<AnyPairs<Query>>(static_cast<AnyPairs<Query>*>(pairs.release()));
}

template <class Query>
constexpr QueryEntry query_of() {
  QueryEntry entry{Query::name,
                   [](std::unique_ptr<PairsUnderSome> pairs, std::span<const TriangleMesh> meshes,
                      const Trace& trace, const Variant& variant, const ReplayOptions& options,
                      ReplayResult& result) {
                     return player_over(under<Query>(std::move(pairs)), meshes, trace, variant,
                                        options, result);
                   },
                   nullptr,
                   [](Trials trials, std::shared_ptr<PairsFrom> from,
                      std::vector<Variant> variants) -> std::unique_ptr<PairsUnderSome> {
                     return std::make_unique<PairsInTurn<Query>>(std::move(trials), std::move(from),
                                                                 std::move(variants));
                   }};
  if constexpr (AnswersYesOrNo<Query>)
    entry.world = [](std::unique_ptr<PairsUnderSome> pairs, const Variant& variant,
                     int threads) -> std::unique_ptr<WorldEngine> {
      return std::make_unique<TouchingWorld<Query>>(under<Query>(std::move(pairs)),
                                                    query_options(variant), threads);
    };
  return entry;
}

}  // namespace bvlab::detail
