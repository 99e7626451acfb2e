// SPDX-License-Identifier: BSD-3-Clause
/// The engine for one volume, compiled by itself: every strategy, query and counter under it.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <thread>

#include "experiments/runner/replay.hpp"
#include "experiments/runner/strategy_text.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

/// As many lanes as a register holds, where registers hold four or more.
template <class T>
using NativeBatch = Batch<T, std::max(native_width<T>, 4)>;

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

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

/// One thread's share: bodies of its own, every `stride`-th pair, all frames.
template <BoundingVolume V, class Strategy, class Query, class Counter>
class Share {
 public:
  Share(std::span<const Shape<V>> shapes, const Strategy& strategy, std::size_t first,
        std::size_t stride, const Trace& trace, Manner manner, ReplayResult& result,
        const ReplayOptions& options)
      : trace_(trace),
        result_(result),
        options_(options),
        first_(first),
        stride_(stride),
        engine_(shapes, share_of(trace.objects, first, stride), strategy),
        answers_(result, trace.frames, trace.pairs(), options.keep_answers, manner) {}

  void play() {
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

  void hand_over() {
    result_.first_seconds = std::max(result_.first_seconds, first_seconds_);
    result_.n_u += counter_.n_u, result_.n_v += counter_.n_v, result_.n_p += counter_.n_p;
    result_.front += entries_;
    result_.hits += answers_.hits;
    answers_.hand_over(result_);
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

template <BoundingVolume V, class Strategy, class Query, class Counter>
void play(std::span<const Shape<V>> shapes, const Strategy& strategy, const Trace& trace,
          Manner manner, const ReplayOptions& options, ReplayResult& result) {
  if (options.keep_series) result.series.resize(trace.frames);
  const std::size_t pairs = trace.pairs();
  // A series is of all pairs together, so one thread plays it.
  const std::size_t threads =
      options.keep_series
          ? 1
          : std::clamp<std::size_t>(options.threads, 1, std::max<std::size_t>(pairs, 1));
  std::deque<Share<V, Strategy, Query, Counter>> shares;
  for (std::size_t t = 0; t < threads; ++t)
    shares.emplace_back(shapes, strategy, t, threads, trace, manner, result, options);
  const auto start = Clock::now();
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < threads; ++t)
      helpers.emplace_back([&share = shares[t]] { share.play(); });
    shares[0].play();
  }
  result.seconds = seconds_since(start);
  for (auto& share : shares) share.hand_over();
  std::sort(result.contacts.begin(), result.contacts.end());
  const double asked = static_cast<double>(pairs) * static_cast<double>(trace.frames);
  result.front = asked > 0 ? result.front / asked : 0;
  // Counts have been running totals so far.
  for (std::size_t frame = result.series.size(); frame-- > 1;) {
    auto& now = result.series[frame];
    const auto& before = result.series[frame - 1];
    now.n_u -= before.n_u, now.n_v -= before.n_v, now.n_p -= before.n_p, now.hits -= before.hits;
  }
}

}  // namespace detail

/// `replay` for one volume; the variant's names have been checked.
template <BoundingVolume V>
ReplayResult replay_with(std::span<const TriangleMesh> meshes, const Trace& trace,
                         const Variant& variant, const ReplayOptions& options) {
  ReplayResult result;
  const auto start = Clock::now();
  std::vector<Hierarchy<V>> hierarchies;
  Builds::with(variant.build, [&]<class Build>(std::type_identity<Build>) {
    for (const auto& mesh : meshes)
      hierarchies.emplace_back(mesh, Build::topology(mesh, variant.leaf_size));
  });
  std::vector<Shape<V>> shapes;
  for (std::size_t i = 0; i < trace.objects; ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  result.build_seconds = seconds_since(start);
  detail::Manner manner{intersect_batch<Exact>, variant.relative_error};
  Precisions::with(variant.precision, [&]<class Precision>(std::type_identity<Precision>) {
    manner.test = intersect_batch<Precision>;
  });
  const bool counted = options.count == Count::on || options.keep_series;
  Strategies::with(name_of(variant.strategy), [&]<class Strategy>(std::type_identity<Strategy>) {
    const auto strategy = made_from<Strategy>(variant.strategy);
    Queries::with(variant.query, [&]<class Query>(std::type_identity<Query>) {
      if (counted)
        detail::play<V, Strategy, Query, Counting>(shapes, strategy, trace, manner, options,
                                                   result);
      else
        detail::play<V, Strategy, Query, NotCounting>(shapes, strategy, trace, manner, options,
                                                      result);
    });
  });
  return result;
}

}  // namespace bvlab
