// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies over binary trees, a strategy for each: what a World asks (see world_of.hpp).
///
/// Threads share the pairs. Bodies are moved and volumes posed when they are first asked for,
/// whoever asks: what is posed and tested is the same for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"
#include "traversal/bodies.hpp"
#include "traversal/once.hpp"

namespace bvlab {

/// Over any kind of bodies: `Bodies` or what offers the same.
template <class BodySet, class Strategy>
class StrategyPairs {
 public:
  /// `bodies` makes the BodySet; each pair begins with a copy of `strategy`.
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

  /// Bodies are moved when the first pair asks for them; `poses` and `origin` must stay until then.
  template <class Query>
  void begin(std::span<const std::uint32_t>, std::span<const Pose> poses,
             const Vec3<double>& origin, Threads& threads) {
    poses_ = poses, origin_ = &origin;
    const Askers askers = threads.count() > 1 ? Askers::several : Askers::one;
    if (askers != askers_) bodies_.asked_by(askers_ = askers);
    if (++frame_ >= never_done) frame_ = 0;
  }
  void stand(std::uint32_t) {}

  template <class Counter, class Ask, class Take>
  void ask(std::span<const std::uint32_t> slots, std::size_t, Counter& counter, Ask&& ask,
           Take&& take) {
    for (const std::uint32_t slot : slots) {
      Asked& asked = pairs_[slot];
      auto query = ask(slot, asked.pair);
      const std::uint64_t before = counter.n_v + counter.n_p;
      for (const auto k : {asked.pair.i, asked.pair.j})
        once(moved_[k], frame_, askers_, [&] { bodies_.move(k, poses_[k], *origin_); });
      asked.strategy.run(bodies_.pair(asked.pair, query, counter));
      counter.asked(before);
      take(slot, asked.pair, query);
    }
  }

  std::size_t front_size(std::uint32_t slot) const { return pairs_[slot].strategy.front_size(); }

 private:
  struct Asked {
    ObjectPair pair;
    Strategy strategy;
  };

  BodySet bodies_;
  Strategy prototype_;
  std::vector<Asked> pairs_;
  std::vector<std::uint32_t> moved_;  // the frame in which each body was moved last
  std::span<const Pose> poses_;
  const Vec3<double>* origin_ = nullptr;
  std::uint32_t frame_ = 0;
  Askers askers_ = Askers::one;
};

}  // namespace bvlab
