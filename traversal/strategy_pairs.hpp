// SPDX-License-Identifier: BSD-3-Clause
/// The pairs of a World over binary trees or any fan-out, each with a strategy of its own (see
/// world_of.hpp).
///
/// The pairs are divided among the threads. The first thread that needs a body moves it and poses
/// its volumes: what is posed and tested is the same for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"
#include "traversal/bodies.hpp"
#include "traversal/once.hpp"

namespace bvlab {

/// BodySet is `Bodies` or a class with the same members.
template <class BodySet, class Strategy>
class StrategyPairs {
 public:
  /// The BodySet is constructed from `bodies`; each pair begins with a copy of `strategy`.
  template <class Made>
  StrategyPairs(Made&& bodies, const Strategy& strategy)
      : bodies_(std::forward<Made>(bodies)),
        prototype_(strategy),
        moved_(bodies_.size(), never_done) {}

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return bodies_.mesh(i); }

  void put(std::uint32_t slot, const ObjectPair& pair) {
    if (slot >= pairs_.size()) pairs_.resize(slot + 1, {{}, prototype_});
    pairs_[slot].pair = pair;
  }
  void drop(std::uint32_t slot) { pairs_[slot].strategy = prototype_; }

  /// Begins a frame. A body is moved when the first of its pairs is queried; `poses` and `origin`
  /// must stay valid until then.
  template <class Query>
  void begin(std::span<const std::uint32_t>, std::span<const Pose> poses,
             const Vec3<double>& origin, Threads& threads) {
    poses_ = poses, origin_ = &origin;
    const Sharing sharing = threads.count() > 1 ? Sharing::several_threads : Sharing::one_thread;
    if (sharing != sharing_) bodies_.set_sharing(sharing_ = sharing);
    if (++frame_ >= never_done) frame_ = 0;
  }
  void set_pose(std::uint32_t) {}

  template <class Counter, class MakeQuery, class Take>
  void run(std::span<const std::uint32_t> slots, std::size_t, Counter& counter,
           MakeQuery&& make_query, Take&& take) {
    for (const std::uint32_t slot : slots) {
      PairState& state = pairs_[slot];
      auto query = make_query(slot, state.pair);
      const std::uint64_t before = counter.n_v + counter.n_p;
      for (const auto k : {state.pair.i, state.pair.j})
        once(moved_[k], frame_, sharing_, [&] { bodies_.move(k, poses_[k], *origin_); });
      state.strategy.run(bodies_.pair(state.pair, query, counter));
      counter.queried(before);
      take(slot, state.pair, query);
    }
  }

  std::size_t front_size(std::uint32_t slot) const { return pairs_[slot].strategy.front_size(); }

 private:
  struct PairState {
    ObjectPair pair;
    Strategy strategy;
  };

  BodySet bodies_;
  Strategy prototype_;
  std::vector<PairState> pairs_;
  std::vector<std::uint32_t> moved_;  // the frame in which each body was moved last
  std::span<const Pose> poses_;
  const Vec3<double>* origin_ = nullptr;
  std::uint32_t frame_ = 0;
  Sharing sharing_ = Sharing::one_thread;
};

}  // namespace bvlab
