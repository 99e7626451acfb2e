// SPDX-License-Identifier: BSD-3-Clause
/// The engine for one volume, compiled by itself: every strategy, query and counter under it.
#pragma once

#include <algorithm>

#include "experiments/runner/hierarchies_of.hpp"
#include "experiments/runner/replay_shares.hpp"
#include "experiments/runner/strategy_text.hpp"
#include "experiments/runner/triangle_test.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

namespace detail {

/// How queries are asked.
struct Manner {
  TriangleTest test;
  double relative_error;
};

/// What one thread finds out about its share of the pairs. Touching and distances fill cells of the
/// shared array, contacts a list of its own.
template <class Query>
struct Answers;

/// One cell of the shared array for each frame and pair.
template <class Cell>
struct Cells {
  std::vector<Cell>* cells;  ///< (frames, pairs), or null where answers are not kept
  std::size_t pairs;
  std::uint64_t hits = 0;

  Cells(std::vector<Cell>& shared, std::size_t frames, std::size_t pairs, bool keep)
      : cells(keep ? &shared : nullptr), pairs(pairs) {
    if (keep) shared.resize(frames * pairs);
  }
  void put(std::size_t frame, std::size_t pair, bool hit, Cell answer) {
    hits += hit;
    if (cells) (*cells)[frame * pairs + pair] = answer;
  }
  void hand_over(ReplayResult&) {}
};

template <>
struct Answers<Touching> : Cells<std::uint8_t> {
  Manner manner;

  Answers(ReplayResult& result, std::size_t frames, std::size_t pairs, bool keep, Manner manner)
      : Cells(result.touching, frames, pairs, keep), manner(manner) {}
  Touching ask() { return Touching(manner.test); }
  void take(std::size_t frame, std::size_t pair, const ObjectPair&, const Touching& query) {
    put(frame, pair, query.touching(), query.touching());
  }
};

template <>
struct Answers<Distance> : Cells<double> {
  Manner manner;

  Answers(ReplayResult& result, std::size_t frames, std::size_t pairs, bool keep, Manner manner)
      : Cells(result.distances, frames, pairs, keep), manner(manner) {}
  Distance ask() { return Distance(manner.relative_error); }
  void take(std::size_t frame, std::size_t pair, const ObjectPair&, const Distance& query) {
    put(frame, pair, query.distance() == 0, query.distance());
  }
};

template <>
struct Answers<Contacts> {
  bool keep;
  Manner manner;
  std::uint64_t hits = 0;
  std::vector<Contact> found;
  std::vector<std::array<std::uint32_t, 5>> all;

  Answers(ReplayResult&, std::size_t, std::size_t, bool keep, Manner manner)
      : keep(keep), manner(manner) {}
  Contacts ask() {
    found.clear();
    return Contacts(found, manner.test);
  }
  void take(std::size_t frame, std::size_t, const ObjectPair& pair, const Contacts&) {
    hits += found.size();
    if (keep)
      for (const auto& [a, b] : found)
        all.push_back({static_cast<std::uint32_t>(frame), pair.i, pair.j, a, b});
  }
  void hand_over(ReplayResult& result) {
    result.contacts.insert(result.contacts.end(), all.begin(), all.end());
  }
};

/// Bodies of its own, every `stride`-th pair, all frames.
template <BoundingVolume V, class Strategy, class Query, class Counter>
class ShareOf final : public Share {
 public:
  ShareOf(std::span<const Shape<V>> shapes, const Strategy& strategy, std::size_t first,
          std::size_t stride, const Trace& trace, Manner manner, ReplayResult& result,
          const ReplayOptions& options)
      : trace_(trace),
        result_(result),
        options_(options),
        first_(first),
        stride_(stride),
        engine_(shapes, share_of(trace.objects, first, stride), strategy),
        answers_(result, trace.frames, trace.pairs(), options.keep_answers, manner) {}

  void play() override {
    const auto start = Clock::now();
    std::vector<Pose> poses(trace_.objects);
    for (std::size_t frame = 0; frame < trace_.frames; ++frame) {
      trace_.poses(frame, poses);
      engine_.frame(
          poses, counter_, [&](std::size_t) { return answers_.ask(); },
          [&](std::size_t p, const Query& query) {
            answers_.take(frame, first_ + p * stride_, engine_.pairs()[p], query);
          });
      const std::size_t front = engine_.front_size();
      entries_ += static_cast<double>(front);
      if (options_.keep_series)
        result_.series[frame] = {counter_.n_u, counter_.n_v, counter_.n_p, front, answers_.hits};
      if (frame == 0) first_seconds_ = seconds_since(start);
    }
  }

  void hand_over(ReplayResult& result) override {
    result.first_seconds = std::max(result.first_seconds, first_seconds_);
    result.n_u += counter_.n_u, result.n_v += counter_.n_v, result.n_p += counter_.n_p;
    result.considered += counter_.considered;
    result.front += entries_;
    result.hits += answers_.hits;
    answers_.hand_over(result);
  }

 private:
  static std::vector<ObjectPair> share_of(std::size_t objects, std::size_t first,
                                          std::size_t stride) {
    const auto all = all_object_pairs(static_cast<std::uint32_t>(objects));
    std::vector<ObjectPair> share;
    for (std::size_t p = first; p < all.size(); p += stride) share.push_back(all[p]);
    return share;
  }

  const Trace& trace_;
  ReplayResult& result_;
  const ReplayOptions& options_;
  std::size_t first_, stride_;
  AllPairs<NativeBatch<typename V::scalar>, V, Strategy> engine_;
  Answers<Query> answers_;
  Counter counter_;
  double entries_ = 0, first_seconds_ = 0;
};

}  // namespace detail

/// `replay` for one volume; the variant's names have been checked.
template <BoundingVolume V>
ReplayResult replay_with(std::span<const TriangleMesh> meshes, const Trace& trace,
                         const Variant& variant, const ReplayOptions& options) {
  ReplayResult result;
  const auto start = Clock::now();
  const auto hierarchies = hierarchies_of<V>(meshes, variant);
  std::vector<Shape<V>> shapes;
  for (std::size_t i = 0; i < trace.objects; ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  result.build_seconds = seconds_since(start);
  const detail::Manner manner{triangle_test(variant.precision), variant.relative_error};
  const bool counted = options.count == Count::on || options.keep_series;
  Strategies::with(name_of(variant.strategy), [&]<class Strategy>(std::type_identity<Strategy>) {
    const auto strategy = made_from<Strategy>(variant.strategy);
    Queries::with(variant.query, [&]<class Query>(std::type_identity<Query>) {
      const auto play = [&]<class Counter>(std::type_identity<Counter>) {
        detail::play_shares(
            trace, options,
            [&](std::size_t first, std::size_t stride, ReplayResult& all) {
              return std::make_unique<detail::ShareOf<V, Strategy, Query, Counter>>(
                  shapes, strategy, first, stride, trace, manner, all, options);
            },
            result);
      };
      if (counted)
        play(std::type_identity<Counting>());
      else
        play(std::type_identity<NotCounting>());
    });
  });
  return result;
}

}  // namespace bvlab
