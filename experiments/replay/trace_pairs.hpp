// SPDX-License-Identifier: BSD-3-Clause
/// The pairs of a trace, queried in every frame. Without a broad phase every pair is, as AllPairsOf
/// does it: each costs at least the test of two roots. With one, pairs are found whose boxes
/// overlap, as in WorldOf, and only these are queried, whether their bodies have moved or not: all
/// others are apart. A frame then costs O(bodies + near pairs), and memory is kept for near pairs
/// alone. Answers are the same either way; counts are not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/near_boxes.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/replay.hpp"
#include "traversal/answers_in_order.hpp"
#include "traversal/bodies.hpp"
#include "traversal/near_pairs.hpp"
#include "traversal/queries/query.hpp"

namespace bvlab::detail {

/// A query that finds nothing where boxes are apart, and whose answer is then that of a query that
/// was never run.
template <class Query>
constexpr bool needs_near_pairs_only() {
  if constexpr (requires { Query::culls_disjoint; })
    return Query::culls_disjoint && (YesOrNoByOneHit<Query> || FindsAllHits<Query>);
  return false;
}

/// Whether a replay uses a broad phase. Throws Unusable where one is asked for and the query needs
/// all pairs.
template <class Query>
bool uses_broad_phase(const Trace& trace, const ReplayOptions& options) {
  constexpr bool possible = needs_near_pairs_only<Query>();
  if (options.broad_phase == BroadPhase::on && !possible)
    throw Unusable("--broad-phase on: not with --query " + std::string(Query::name) +
                   ", which has an answer for pairs whose boxes are apart");
  return options.broad_phase == BroadPhase::on || (possible && broad_phase_pays(trace, options));
}

/// The place of each pair among the pairs of a trace.
class PlacesOfPairs {
 public:
  explicit PlacesOfPairs(const Trace& trace) : objects_(trace.objects), all_(!trace.chosen) {
    if (all_) return;
    for (const ObjectPair& pair : *trace.chosen) places_.emplace(key_of(pair), places_.size());
  }
  std::size_t operator()(const ObjectPair& pair) const {
    if (!all_) return places_.at(key_of(pair));
    const std::size_t i = pair.i;
    return i * (2 * objects_ - i - 1) / 2 + (pair.j - i - 1);
  }

 private:
  static std::uint64_t key_of(const ObjectPair& pair) {
    return std::uint64_t{pair.i} << 32 | pair.j;
  }

  std::size_t objects_;
  bool all_;
  std::unordered_map<std::uint64_t, std::size_t> places_;
};

template <class Query>
class TracePairs {
 public:
  /// `pairs` has the bodies, and no pairs yet.
  TracePairs(PairsAsked<Query> pairs, const Trace& trace, BroadPhase broad_phase, int threads)
      : pairs_(std::move(pairs)),
        threads_(broad_phase == BroadPhase::on ? 1 : threads),
        place_of_(trace) {
    if (broad_phase == BroadPhase::on) {
      near_.emplace(pairs_.size(), threads,
                    [this](std::size_t i) -> const TriangleMesh& { return pairs_.mesh(i); });
      if (trace.chosen) near_->choose(PairFilter(PairChoice{.only = *trace.chosen}));
      return;
    }
    const std::vector<ObjectPair> all = object_pairs(trace);
    // The last slot first: room for all is made at once.
    for (std::size_t p = all.size(); p-- > 0;) pairs_.put(static_cast<std::uint32_t>(p), all[p]);
    (*pairs_).make_room(threads_);
    slots_.resize(all.size());
    std::iota(slots_.begin(), slots_.end(), 0u);
  }
  TracePairs(const TracePairs&) = delete;
  TracePairs& operator=(const TracePairs&) = delete;

  /// Moves all bodies, and queries the pairs.
  void frame(std::span<const Pose> poses, Counting& counter, Answers<Query>& answers) {
    Asking<Query> asking{.how = {}, .answers = &answers};
    if (near_) {
      asking.places = &places_;
      find_near(poses);
    } else {
      if (!origin_) origin_ = centre_of(poses, pairs_);
      (*pairs_).begin_all(poses, *origin_, threads_, counter, asking);
    }
    answers_.run_pairs(pairs_, near_ ? near_->threads() : threads_,
                       std::span<const std::uint32_t>(slots_), pairs_.pairs().size(), counter,
                       asking, asking);
    if (near_) near_->settle();
  }

  AnyPairs<Query>& pairs() const { return *pairs_; }
  /// The pairs whose boxes overlapped in the last frame, where a broad phase finds them.
  std::optional<std::size_t> near() const {
    return near_ ? std::optional(near_->size()) : std::nullopt;
  }

 private:
  void find_near(std::span<const Pose> poses) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      near_->move(static_cast<std::uint32_t>(i), poses[i]);
    pairs_.template begin<Query>(near_->movers(), near_->poses(), near_->origin(),
                                 near_->threads());
    near_->update([&](std::uint32_t i) { pairs_.set_pose(i); },
                  [&](std::uint32_t slot, const ObjectPair& pair) {
                    pairs_.put(slot, pair);
                    if (slot >= places_.size()) places_.resize(slot + 1);
                    places_[slot] = place_of_(pair);
                  },
                  [&](std::uint32_t slot) { pairs_.drop(slot); });
    slots_.clear();
    for (std::uint32_t slot = 0; slot < near_->slots(); ++slot)
      if (near_->taken(slot)) slots_.push_back(slot);
  }

  PairsAsked<Query> pairs_;
  Threads threads_;
  PlacesOfPairs place_of_;
  AnswersInOrder answers_;
  std::vector<std::uint32_t> slots_;  // that are queried
  std::optional<Vec3<double>> origin_;
  // With a broad phase:
  std::optional<NearPairs<NearBoxes>> near_;
  std::vector<std::size_t> places_;  // of each slot's pair
};

}  // namespace bvlab::detail
