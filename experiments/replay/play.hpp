// SPDX-License-Identifier: BSD-3-Clause
/// Replays and whole scenes of one strategy under one query, over bodies of any volume: compiled by
/// itself.
#pragma once

#include <algorithm>
#include <concepts>
#include <deque>
#include <memory>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/play_entry.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/strategy_text.hpp"
#include "experiments/replay/touching_world.hpp"
#include "experiments/replay/trace_pairs.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "traversal/counters.hpp"
#include "traversal/strategy_pairs.hpp"

namespace bvlab {

namespace detail {

/// What is found out about the pairs: a cell for each frame and pair, or a list, as the query has
/// it.
template <class Query>
class Answers {
  static constexpr bool lists =
      requires(const QueryOptions& options, std::vector<std::array<std::uint32_t, 2>>& found) {
        Query::from_options(options, found);
      };
  static constexpr bool finds_nearest = requires(const Query& query) { query.nearest(); };

 public:
  Answers(ReplayResult& result, const Trace& trace, const ReplayOptions& options,
          const QueryOptions& how)
      : result_(&result), pairs_(trace.pairs()), keep_(options.keep_answers), how_(how) {
    if constexpr (lists) {
      if (options.threads > 1) of_pairs_.resize(pairs_);
    } else {
      if (keep_) cells().resize(trace.frames * pairs_);
      if constexpr (finds_nearest)
        if (options.keep_nearest) result.nearest.resize(trace.frames * pairs_);
    }
  }

  /// Several pairs may be asked before the first of them is taken; of threads, at once.
  Query ask(std::size_t p) {
    if constexpr (lists) {
      auto& found = list_of(p).found;
      found.clear();
      return Query::from_options(how_, found);
    } else {
      return Query::from_options(how_);
    }
  }

  /// `nearest(found)` gives the points of the nearest triangles.
  template <class Nearest>
  void take(std::size_t frame, std::size_t p, const ObjectPair& pair, const Query& query,
            const Nearest& nearest) {
    if constexpr (lists) {
      List& list = list_of(p);
      hits_ += list.found.size();
      if (keep_)
        for (const auto& [a, b] : list.found)
          result_->contacts.push_back({static_cast<std::uint32_t>(frame), pair.i, pair.j, a, b});
      list.pair = nobody;
    } else {
      const auto answer = query.answer();
      if constexpr (std::same_as<decltype(answer), const bool>)
        hits_ += answer;
      else
        hits_ += answer == 0;
      if (keep_) cells()[frame * pairs_ + p] = answer;
      if constexpr (finds_nearest)
        if (!result_->nearest.empty())
          result_->nearest[frame * pairs_ + p] = nearest(query.nearest());
    }
  }

  std::uint64_t hits() const { return hits_; }

 private:
  static constexpr std::size_t nobody = static_cast<std::size_t>(-1);
  struct List {
    std::size_t pair = nobody;
    std::vector<std::array<std::uint32_t, 2>> found;
  };

  /// The pair's, or one that nobody has: queries point to it. With threads each pair has its own.
  List& list_of(std::size_t pair) {
    if (!of_pairs_.empty()) return of_pairs_[pair];
    List* free = nullptr;
    for (List& list : open_) {
      if (list.pair == pair) return list;
      if (list.pair == nobody) free = &list;
    }
    if (!free) free = &open_.emplace_back();
    free->pair = pair;
    return *free;
  }

  auto& cells() {
    if constexpr (std::same_as<decltype(std::declval<Query>().answer()), bool>)
      return result_->touching;
    else
      return result_->distances;
  }

  ReplayResult* result_;
  std::size_t pairs_;
  bool keep_;
  QueryOptions how_;
  std::uint64_t hits_ = 0;
  std::deque<List> open_;
  std::vector<List> of_pairs_;
};

inline bool counts(const ReplayOptions& options) {
  return options.count == Count::on || options.keep_series;
}

template <class Pairs, class Query, class Counter>
class PlayedBy final : public Player {
 public:
  PlayedBy(Pairs pairs, const Trace& trace, const QueryOptions& how, const ReplayOptions& options,
           ReplayResult& result)
      : result_(result),
        options_(options),
        engine_(std::move(pairs), trace,
                uses_broad_phase<Query>(trace, options) ? BroadPhase::on : BroadPhase::off,
                static_cast<int>(options.threads)),
        answers_(result, trace, options, how),
        poses_(trace) {}

  void play(std::size_t frame) override {
    const std::span<const Pose> poses = poses_.at(frame);
    Pairs& pairs = engine_.pairs();
    engine_.frame(
        poses, counter_, [&](std::size_t p) { return answers_.ask(p); },
        [&](std::size_t p, const ObjectPair& pair, const Query& query) {
          answers_.take(frame, p, pair, query, [&](const NearestTriangles& found) {
            return nearest_points(found, pairs.mesh(pair.i), poses[pair.i], pairs.mesh(pair.j),
                                  poses[pair.j]);
          });
        });
    if constexpr (requires { pairs.bodies().count_posed(counter_); })
      pairs.bodies().count_posed(counter_);
    const std::size_t front = pairs.front_size();
    result_.front += static_cast<double>(front);
    if (options_.keep_series)
      result_.series.push_back({counter_.n_u, counter_.n_v, counter_.n_p, front, answers_.hits()});
    if (const auto near = engine_.near()) result_.near = result_.near.value_or(0) + *near;
    if constexpr (requires { pairs.strategy(0).front().entries(); })
      if (options_.see_front)
        for (std::size_t p = 0; p < pairs.pairs().size(); ++p)
          options_.see_front(frame, p, pairs.strategy(p).front().entries());
  }

  void finish() override {
    result_.hits += answers_.hits();
    if (!counts(options_)) return;
    result_.n_b += counter_.n_b, result_.n_u += counter_.n_u, result_.n_v += counter_.n_v;
    result_.n_p += counter_.n_p, result_.considered += counter_.considered;
  }

 private:
  ReplayResult& result_;
  const ReplayOptions& options_;
  TracePairs<Pairs> engine_;
  Answers<Query> answers_;
  PosesInTurn poses_;
  Counter counter_;
};

/// All the fronts that a strategy may start from.
template <class Strategy, class List = Fronts>
struct FrontsOf {
  using type = Fronts;
};
template <class Strategy, class... Shared>
  requires requires { typename Strategy::OwnFronts; }
struct FrontsOf<Strategy, TypeList<Shared...>> {
  template <class... Own>
  static TypeList<Shared..., Own...> with(TypeList<Own...>);
  using type = decltype(with(typename Strategy::OwnFronts{}));
};

template <class Strategy, class Query, class Counter>
using BodiesFor = AnyBodies<Query, Counter, typename FrontsOf<Strategy>::type>;

template <class Strategy, class Query, class Counter>
BodiesFor<Strategy, Query, Counter> bodies_for(const VolumeEntry& volume,
                                               const AnyHierarchies& hierarchies,
                                               std::size_t objects, const Variant& variant) {
  return BodiesFor<Strategy, Query, Counter>(
      loops_of<Query>(volume.name).bodies(hierarchies, objects, frame_of(variant)),
      [&](const std::type_info& front) { return own_loop<Query>(volume.name, front); });
}

/// `pairs` are of none yet.
template <class Query, class Counter, class Pairs>
void play_over(Pairs pairs, const Trace& trace, const Variant& variant,
               const ReplayOptions& options, ReplayResult& result) {
  const QueryOptions how{triangle_test(variant.precision), variant.relative_error};
  PlayedBy<Pairs, Query, Counter> player(std::move(pairs), trace, how, options, result);
  play_frames(player, trace, options, result);
}

/// `pairs` makes them for either way to count.
template <class Query, class PairsOf>
void play_counting_or_not(const PairsOf& pairs, const Trace& trace, const Variant& variant,
                          const ReplayOptions& options, ReplayResult& result) {
  const auto with = [&]<class Counter>(std::type_identity<Counter> counter) {
    play_over<Query, Counter>(pairs(counter), trace, variant, options, result);
  };
  if (counts(options))
    with(std::type_identity<Counting>());
  else
    with(std::type_identity<NotCounting>());
}

template <class Strategy, class Query>
void play(const VolumeEntry& volume, const AnyHierarchies& hierarchies, const Trace& trace,
          const Variant& variant, const ReplayOptions& options, ReplayResult& result) {
  const auto strategy = made_from<Strategy>(variant.strategy);
  const auto pairs = [&]<class Counter>(std::type_identity<Counter>) {
    return StrategyPairs<BodiesFor<Strategy, Query, Counter>, Strategy>(
        bodies_for<Strategy, Query, Counter>(volume, hierarchies, trace.objects, variant),
        strategy);
  };
  play_counting_or_not<Query>(pairs, trace, variant, options, result);
}

/// Null where the query is no matter of yes or no.
template <class Strategy, class Query>
std::unique_ptr<WorldEngine> world(const VolumeEntry& volume,
                                   std::unique_ptr<AnyHierarchies> hierarchies, std::size_t objects,
                                   const Variant& variant, int threads) {
  using Pairs = StrategyPairs<BodiesFor<Strategy, Query, NotCounting>, Strategy>;
  if constexpr (AnswersYesOrNo<Query>) {
    Pairs pairs(bodies_for<Strategy, Query, NotCounting>(volume, *hierarchies, objects, variant),
                made_from<Strategy>(variant.strategy));
    return std::make_unique<TouchingWorld<Pairs, Query, HierarchiesByMesh>>(
        HierarchiesByMesh(volume, std::move(hierarchies), variant), std::move(pairs), variant,
        threads);
  } else {
    return nullptr;
  }
}

}  // namespace detail

template <class Strategy, class Query>
constexpr PlayEntry play_of() {
  return {Strategy::name,
          Strategy::description,
          Query::name,
          Query::description,
          [](std::string_view text) { made_from<Strategy>(text); },
          detail::play<Strategy, Query>,
          detail::world<Strategy, Query>};
}

}  // namespace bvlab
