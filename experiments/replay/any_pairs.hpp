// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies whose volume, strategy and kernel are known inside alone. A frame calls through
/// a pointer once for many pairs, so replays and whole scenes are compiled once for each query, and
/// the fast loops below pay nothing for it.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "experiments/replay/answers.hpp"
#include "experiments/replay/made_pairs.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "traversal/counters.hpp"

namespace bvlab::detail {

/// What pairs that choose among variants have chosen (PairsInTurn), in which seconds of their
/// frames.
struct ChoiceInTurn {
  std::string reason;
  double build_seconds, choosing_seconds;
};

/// What is not documented here is as in AllPairsOf and WorldOf.
template <class Query>
class AnyPairs : public PairsUnderSome {
 public:
  virtual std::size_t size() const = 0;
  virtual const TriangleMesh& mesh(std::size_t i) const = 0;
  virtual const Vec3<double>& mesh_origin(std::size_t i) const = 0;
  /// Builds what its bodies need of a mesh that was not there. It must outlive this.
  virtual void add(const TriangleMesh& mesh) = 0;
  virtual void put(std::uint32_t slot, const ObjectPair& pair) = 0;
  virtual void drop(std::uint32_t slot) = 0;
  virtual void make_room(Threads& threads) = 0;
  virtual void begin_all(std::span<const Pose> poses, const Vec3<double>& origin, Threads& threads,
                         Counting& counter, const Asking<Query>& asking) = 0;
  virtual void begin(std::span<const std::uint32_t> movers, std::span<const Pose> poses,
                     const Vec3<double>& origin, Threads& threads) = 0;
  virtual void set_pose(std::uint32_t i) = 0;
  virtual void run(std::span<const std::uint32_t> slots, std::size_t worker, Counting& counter,
                   const Asking<Query>& asking) = 0;
  virtual const std::vector<ObjectPair>& pairs() const = 0;
  virtual std::size_t front_size() const = 0;

  /// Counts the volumes that have been posed since this was called last, where that is not counted
  /// at once.
  virtual void count_posed(Counting& counter) = 0;
  /// Calls with the number of each pair, and with its front if that is a list of pairs of nodes.
  virtual void see_fronts(
      const std::function<void(std::size_t pair, std::span<const NodePair>)>& see) const = 0;
  /// Of trees that are built on demand: their nodes, and how many of them have been made.
  virtual std::array<std::size_t, 2> nodes() const = 0;
  virtual std::optional<ChoiceInTurn> choice() const { return {}; }
};

/// `Hierarchies` holds those of all meshes; `of(mesh)` is what Pairs has for a body of a mesh.
template <class Pairs, class Query, class Hierarchies>
class PairsOver final : public AnyPairs<Query> {
 public:
  /// `pairs` are of bodies over what `hierarchies` holds, and of no pairs yet.
  PairsOver(std::shared_ptr<Hierarchies> hierarchies, Pairs pairs)
      : hierarchies_(std::move(hierarchies)), pairs_(std::move(pairs)) {}

  std::size_t size() const override { return pairs_.size(); }
  const TriangleMesh& mesh(std::size_t i) const override { return pairs_.mesh(i); }
  const Vec3<double>& mesh_origin(std::size_t i) const override { return pairs_.mesh_origin(i); }
  void add(const TriangleMesh& mesh) override { pairs_.add(hierarchies_->of(mesh)); }
  void put(std::uint32_t slot, const ObjectPair& pair) override { pairs_.put(slot, pair); }
  void drop(std::uint32_t slot) override { pairs_.drop(slot); }
  void make_room(Threads& threads) override { pairs_.make_room(threads); }
  void begin_all(std::span<const Pose> poses, const Vec3<double>& origin, Threads& threads,
                 Counting& counter, const Asking<Query>& asking) override {
    pairs_.begin_all(poses, origin, threads, counter, asking);
  }
  void begin(std::span<const std::uint32_t> movers, std::span<const Pose> poses,
             const Vec3<double>& origin, Threads& threads) override {
    pairs_.template begin<Query>(movers, poses, origin, threads);
  }
  void set_pose(std::uint32_t i) override { pairs_.set_pose(i); }
  void run(std::span<const std::uint32_t> slots, std::size_t worker, Counting& counter,
           const Asking<Query>& asking) override {
    pairs_.run(slots, worker, counter, asking, asking);
  }
  const std::vector<ObjectPair>& pairs() const override { return pairs_.pairs(); }
  std::size_t front_size() const override { return pairs_.front_size(); }

  void count_posed([[maybe_unused]] Counting& counter) override {
    if constexpr (requires { pairs_.count_posed(counter); }) pairs_.count_posed(counter);
  }
  void see_fronts(
      [[maybe_unused]] const std::function<void(std::size_t, std::span<const NodePair>)>& see)
      const override {
    if constexpr (requires { pairs_.strategy(0).front().entries(); })
      for (std::size_t p = 0; p < pairs().size(); ++p) see(p, pairs_.strategy(p).front().entries());
  }
  std::array<std::size_t, 2> nodes() const override {
    if constexpr (requires { hierarchies_->nodes(); })
      return hierarchies_->nodes();
    else
      return {};
  }

 private:
  std::shared_ptr<Hierarchies> hierarchies_;
  Pairs pairs_;
};

/// Pairs as WorldOf and TracePairs take them.
template <class Query>
class PairsAsked {
 public:
  explicit PairsAsked(std::unique_ptr<AnyPairs<Query>> pairs) : pairs_(std::move(pairs)) {}
  AnyPairs<Query>& operator*() const { return *pairs_; }

  std::size_t size() const { return pairs_->size(); }
  const TriangleMesh& mesh(std::size_t i) const { return pairs_->mesh(i); }
  const Vec3<double>& mesh_origin(std::size_t i) const { return pairs_->mesh_origin(i); }
  void add(const TriangleMesh& mesh) { pairs_->add(mesh); }
  void put(std::uint32_t slot, const ObjectPair& pair) { pairs_->put(slot, pair); }
  void drop(std::uint32_t slot) { pairs_->drop(slot); }
  template <class SameQuery>
  void begin(std::span<const std::uint32_t> movers, std::span<const Pose> poses,
             const Vec3<double>& origin, Threads& threads) {
    pairs_->begin(movers, poses, origin, threads);
  }
  void set_pose(std::uint32_t i) { pairs_->set_pose(i); }
  const std::vector<ObjectPair>& pairs() const { return pairs_->pairs(); }

  template <class Counter>
  void run(std::span<const std::uint32_t> slots, std::size_t worker, Counter& counter,
           const Asking<Query>& asking, const Asking<Query>&) {
    Counting counting;
    pairs_->run(slots, worker, counting, asking);
    counter.add(counting);
  }
  /// On one of several threads: `keep` receives the answers for the thread that takes them.
  template <class Counter, class Keep>
    requires(!std::same_as<std::remove_cvref_t<Keep>, Asking<Query>>)
  void run(std::span<const std::uint32_t> slots, std::size_t worker, Counter& counter,
           const Asking<Query>& asking, Keep&& keep) {
    std::vector<typename Asking<Query>::Answered> answered;
    answered.reserve(slots.size());
    Asking<Query> later = asking;
    later.later = &answered;
    run(slots, worker, counter, later, later);
    for (const auto& [slot, query] : answered) keep(slot, pairs()[slot], query);
  }

 private:
  std::unique_ptr<AnyPairs<Query>> pairs_;
};

}  // namespace bvlab::detail
