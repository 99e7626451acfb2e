// SPDX-License-Identifier: BSD-3-Clause
/// The frame loop that all peers share, so that they are timed as our engine is: every frame all
/// bodies are placed and all pairs queried; building is timed by itself.
#pragma once

#include <algorithm>
#include <chrono>
#include <concepts>
#include <memory>

#include "experiments/peers/peers.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/queries/contacts.hpp"

namespace bvlab {

/// W is a peer's world: W(meshes, objects); place(i, pose); what it answers of touching(i, j),
/// distance(i, j) (0 where they touch) and contacts(i, j, found), which may repeat a pair of
/// triangles (repeats are dropped when answers are kept, not while the clock runs); and
/// counter(), where the library counts.
template <class W>
class PeerPlay {
 public:
  PeerPlay(std::span<const TriangleMesh> meshes, const Trace& trace, const ReplayOptions& options)
      : trace_(trace),
        options_(options),
        pairs_(object_pairs(trace)),
        start_(Clock::now()),
        world_(meshes, trace.objects) {
    result_.build_seconds = since_start();
  }

  ReplayResult play(std::string_view query) {
    if (query == "touching") {
      if constexpr (requires { world_.touching(0, 0); })
        each_frame([&](auto i, auto j) { return world_.touching(i, j); }, result_.touching);
    } else if (query == "distance") {
      if constexpr (requires { world_.distance(0, 0); })
        each_frame([&](auto i, auto j) { return world_.distance(i, j); }, result_.distances);
    } else {
      if constexpr (requires { world_.contacts(0, 0, found_); }) each_contact();
    }
    if constexpr (requires { world_.counter(); })
      result_.n_v = world_.counter().n_v, result_.n_p = world_.counter().n_p;
    return std::move(result_);
  }

 private:
  using Clock = std::chrono::steady_clock;

  double since_start() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  static bool is_hit(bool touching) { return touching; }
  static bool is_hit(double distance) { return distance == 0; }

  template <class Ask, class Cell>
  void each_frame(const Ask& ask, std::vector<Cell>& answers) {
    if (options_.keep_answers) answers.resize(trace_.frames * pairs_.size());
    std::size_t cell = 0;
    each_pair([&](std::size_t, const ObjectPair& pair) {
      const auto answer = ask(pair.i, pair.j);
      result_.hits += is_hit(answer);
      if (options_.keep_answers) answers[cell++] = answer;
    });
  }

  void each_contact() {
    each_pair([&](std::size_t frame, const ObjectPair& pair) {
      found_.clear();
      world_.contacts(pair.i, pair.j, found_);
      result_.hits += found_.size();
      if (options_.keep_answers)
        for (const auto& [a, b] : found_)
          result_.contacts.push_back({static_cast<std::uint32_t>(frame), pair.i, pair.j, a, b});
    });
    std::sort(result_.contacts.begin(), result_.contacts.end());
    result_.contacts.erase(std::unique(result_.contacts.begin(), result_.contacts.end()),
                           result_.contacts.end());
  }

  template <class Ask>
  void each_pair(const Ask& ask) {
    PosesInTurn poses_in_turn(trace_);
    start_ = Clock::now();
    double last = 0;
    for (std::size_t frame = 0; frame < trace_.frames; ++frame) {
      const auto poses = poses_in_turn.at(frame);
      for (std::size_t i = 0; i < poses.size(); ++i) world_.place(i, poses[i]);
      for (const auto& pair : pairs_) ask(frame, pair);
      if (frame == 0) result_.first_seconds = since_start();
      if (options_.keep_frame_seconds) {
        const double now = since_start();
        result_.frame_seconds.push_back(now - last);
        last = now;
      }
    }
    result_.seconds = since_start();
  }

  const Trace& trace_;
  const ReplayOptions& options_;
  std::vector<ObjectPair> pairs_;
  Clock::time_point start_;
  W world_;
  ReplayResult result_;
  std::vector<Contact> found_;
};

template <class W>
ReplayResult play_peer(std::span<const TriangleMesh> meshes, const Trace& trace,
                       std::string_view query, const ReplayOptions& options) {
  return PeerPlay<W>(meshes, trace, options).play(query);
}

/// The same of a library that can count.
template <class Counting, class NotCounting>
ReplayResult play_counting_peer(std::span<const TriangleMesh> meshes, const Trace& trace,
                                std::string_view query, const ReplayOptions& options) {
  return options.count == Count::on ? play_peer<Counting>(meshes, trace, query, options)
                                    : play_peer<NotCounting>(meshes, trace, query, options);
}

}  // namespace bvlab
