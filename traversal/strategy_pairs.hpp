// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies over binary trees, a strategy for each: what a World asks (see world_of.hpp).
///
/// Threads share the pairs. Volumes are posed when they are first asked for, whoever asks, so two
/// pairs that have a body in common take turns: what is posed and tested is the same for any number
/// of threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"
#include "traversal/bodies.hpp"

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
        held_(std::make_unique<std::atomic_flag[]>(bodies_.size())) {}

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
    poses_ = poses, origin_ = &origin, shared_ = threads.count() > 1;
  }
  void stand(std::uint32_t) {}

  template <class Counter, class Ask, class Take>
  void ask(std::span<const std::uint32_t> slots, std::size_t, Counter& counter, Ask&& ask,
           Take&& take) {
    for (const std::uint32_t slot : slots) {
      Asked& asked = pairs_[slot];
      auto query = ask(slot, asked.pair);
      const Both both(*this, asked.pair);
      const std::uint64_t before = counter.n_v + counter.n_p;
      for (const auto k : {asked.pair.i, asked.pair.j}) bodies_.move(k, poses_[k], *origin_);
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

  /// Holds two bodies, the one with the smaller index first, so that nobody waits in a circle.
  class Both {
   public:
    Both(StrategyPairs& of, const ObjectPair& pair) : of_(of), pair_(pair) {
      if (of_.shared_) of_.hold(pair_.i), of_.hold(pair_.j);
    }
    ~Both() {
      if (of_.shared_) of_.let_go(pair_.j), of_.let_go(pair_.i);
    }
    Both(const Both&) = delete;
    Both& operator=(const Both&) = delete;

   private:
    StrategyPairs& of_;
    const ObjectPair& pair_;
  };
  void hold(std::uint32_t body) {
    while (held_[body].test_and_set(std::memory_order_acquire))
      held_[body].wait(true, std::memory_order_relaxed);
  }
  void let_go(std::uint32_t body) {
    held_[body].clear(std::memory_order_release);
    held_[body].notify_one();
  }

  BodySet bodies_;
  Strategy prototype_;
  std::vector<Asked> pairs_;
  std::unique_ptr<std::atomic_flag[]> held_;  // by a thread
  std::span<const Pose> poses_;
  const Vec3<double>* origin_ = nullptr;
  bool shared_ = false;  // among threads
};

}  // namespace bvlab
