// SPDX-License-Identifier: BSD-3-Clause
/// The queries of a frame and their answers, of one type for every kind of pairs and of run, so
/// that pairs are compiled once for each query.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "traversal/nearest_points.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/world_of.hpp"

namespace bvlab::detail {

/// What a replay finds out about the pairs: a cell for each frame and pair, or a list, as the query
/// has it.
template <class Query>
class Answers {
  static constexpr bool lists =
      requires(const QueryOptions& options, std::vector<std::array<std::uint32_t, 2>>& found) {
        Query::from_options(options, found);
      };
  static constexpr bool finds_nearest = requires(const Query& query) { query.nearest(); };

 public:
  Answers(ReplayResult& result, std::span<const TriangleMesh> meshes, const Trace& trace,
          const ReplayOptions& options, const QueryOptions& how)
      : result_(&result),
        meshes_(meshes),
        pairs_(trace.pairs()),
        keep_(options.keep_answers),
        how_(how) {
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

  /// `poses` are those of all bodies, until the frame ends.
  void begin_frame(std::size_t frame, std::span<const Pose> poses) {
    frame_ = frame, poses_ = poses;
  }
  void take(std::size_t p, const ObjectPair& pair, const Query& query) {
    if constexpr (lists) {
      List& list = list_of(p);
      hits_ += list.found.size();
      if (keep_)
        for (const auto& [a, b] : list.found)
          result_->contacts.push_back({static_cast<std::uint32_t>(frame_), pair.i, pair.j, a, b});
      list.pair = nobody;
    } else {
      const auto answer = query.answer();
      if constexpr (std::same_as<decltype(answer), const bool>)
        hits_ += answer;
      else
        hits_ += answer == 0;
      if (keep_) cells()[frame_ * pairs_ + p] = answer;
      if constexpr (finds_nearest)
        if (!result_->nearest.empty())
          result_->nearest[frame_ * pairs_ + p] = nearest_points(
              query.nearest(), mesh(pair.i), poses_[pair.i], mesh(pair.j), poses_[pair.j]);
    }
  }

  /// The answer to a query is not wanted.
  void drop(std::size_t p) {
    if constexpr (lists) list_of(p).pair = nobody;
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

  const TriangleMesh& mesh(std::size_t object) const { return meshes_[object % meshes_.size()]; }
  auto& cells() {
    if constexpr (std::same_as<decltype(std::declval<Query>().answer()), bool>)
      return result_->touching;
    else
      return result_->distances;
  }

  ReplayResult* result_;
  std::span<const TriangleMesh> meshes_;
  std::size_t pairs_;
  bool keep_;
  QueryOptions how_;
  std::uint64_t hits_ = 0;
  std::size_t frame_ = 0;
  std::span<const Pose> poses_;
  std::deque<List> open_;
  std::vector<List> of_pairs_;
};

/// Makes the query of each pair, and takes it with its answer.
template <class Query>
struct Asking {
  /// A query that was answered on another thread than the one that takes it.
  struct Answered {
    std::uint32_t slot;
    Query query;
  };

  QueryOptions how;
  Answers<Query>* answers = nullptr;                 ///< of a replay
  const std::vector<std::size_t>* places = nullptr;  ///< of slots in it; null: the same
  TouchingPairs* touching = nullptr;                 ///< of a whole scene
  std::vector<Answered>* later = nullptr;  ///< where the answers go that another thread takes
  bool drops = false;                      ///< the same queries were answered by others

  Query operator()(std::uint32_t slot, const ObjectPair&) const {
    if constexpr (AnswersYesOrNo<Query>)
      if (touching) return Query::from_options(how);
    return answers->ask(place(slot));
  }
  void operator()(std::uint32_t slot, const ObjectPair& pair, const Query& query) const {
    if (drops) return answers ? answers->drop(place(slot)) : void();
    if (later) return later->push_back({slot, query});
    if constexpr (AnswersYesOrNo<Query>)
      if (touching) return touching->put(slot, pair, query.answer());
    answers->take(place(slot), pair, query);
  }

 private:
  std::size_t place(std::uint32_t slot) const { return places ? (*places)[slot] : slot; }
};

}  // namespace bvlab::detail
