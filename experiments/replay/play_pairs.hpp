// SPDX-License-Identifier: BSD-3-Clause
/// Replays and whole scenes over pairs of any kind, compiled once for each query (played.cpp.in).
#pragma once

#include <memory>
#include <span>

#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/world_frames.hpp"

namespace bvlab::detail {

/// All must outlive the player.
template <class Query>
std::unique_ptr<Player> player_over(std::unique_ptr<AnyPairs<Query>> pairs,
                                    std::span<const TriangleMesh> meshes, const Trace& trace,
                                    const Variant& variant, const ReplayOptions& options,
                                    ReplayResult& result);

/// Null where the query is no matter of yes or no.
template <class Query>
std::unique_ptr<WorldEngine> world_of_pairs(std::unique_ptr<AnyPairs<Query>> pairs,
                                            const Variant& variant, int threads);

template <class Query>
void play_pairs(std::unique_ptr<AnyPairs<Query>> pairs, std::span<const TriangleMesh> meshes,
                const Trace& trace, const Variant& variant, const ReplayOptions& options,
                ReplayResult& result) {
  play_frames(*player_over(std::move(pairs), meshes, trace, variant, options, result), trace,
              options, result);
}

}  // namespace bvlab::detail
