// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies that find out while they are asked which of several variants is fastest for them
/// (trials.hpp). A variant that is tried is asked the same as the one that answers, and its answers
/// are dropped; its pairs go when its trial is over, its trees stay.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/trials.hpp"

namespace bvlab::detail {

template <class Query>
class PairsInTurn final : public AnyPairs<Query> {
  using Pairs = AnyPairs<Query>;

 public:
  /// Variant k is that of candidate k.
  PairsInTurn(Trials trials, std::shared_ptr<PairsFrom> from, std::vector<Variant> variants)
      : trials_(std::move(trials)), from_(std::move(from)), variants_(std::move(variants)) {
    const auto start = Clock::now();
    const double built = from_->build_seconds();
    answering_ = make(trials_.current());
    built_before_ = from_->build_seconds();
    trials_.expect_pairs(1e9 * (seconds_since(start) - (built_before_ - built)));
  }

  std::size_t size() const override { return answering_->size(); }
  const TriangleMesh& mesh(std::size_t i) const override { return answering_->mesh(i); }
  const Vec3<double>& mesh_origin(std::size_t i) const override {
    return answering_->mesh_origin(i);
  }
  void add(const TriangleMesh& mesh) override {
    added_.push_back(&mesh);
    each([&](Pairs& pairs) { pairs.add(mesh); });
  }
  void put(std::uint32_t slot, const ObjectPair& pair) override {
    if (slot >= taken_.size()) taken_.resize(slot + 1);
    taken_[slot] = true;
    each([&](Pairs& pairs) { pairs.put(slot, pair); });
  }
  void drop(std::uint32_t slot) override {
    taken_[slot] = false;
    each([&](Pairs& pairs) { pairs.drop(slot); });
  }
  void make_room(Threads& threads) override { answering_->make_room(threads); }

  void begin_all(std::span<const Pose> poses, const Vec3<double>& origin, Threads& threads,
                 Counting& counter, const Asking<Query>& asking) override {
    if (begin_frame()) tried_->make_room(threads);
    timed(answered_, [&] { answering_->begin_all(poses, origin, threads, counter, asking); });
    Counting dropped;
    if (tried_) timed(beside_, [&] { tried_->begin_all(poses, origin, threads, dropped, asking); });
  }
  void begin(std::span<const std::uint32_t> movers, std::span<const Pose> poses,
             const Vec3<double>& origin, Threads& threads) override {
    const bool is_fresh = begin_frame();
    has_moved_.resize(size());
    for (const std::uint32_t i : movers) has_moved_[i] = true;
    timed(answered_, [&] { answering_->begin(movers, poses, origin, threads); });
    if (!tried_) return;
    if (!is_fresh) return timed(beside_, [&] { tried_->begin(movers, poses, origin, threads); });
    // All bodies are new to it. There was a frame before, so that the origin is known.
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < has_moved_.size(); ++i)
      if (has_moved_[i]) all.push_back(i);
    tried_->begin(all, poses, origin, threads);
    for (const std::uint32_t i : all) tried_->set_pose(i);
  }
  void set_pose(std::uint32_t i) override {
    each([&](Pairs& pairs) { pairs.set_pose(i); });
  }
  void run(std::span<const std::uint32_t> slots, std::size_t worker, Counting& counter,
           const Asking<Query>& asking) override {
    timed(answered_, [&] { answering_->run(slots, worker, counter, asking); });
    if (!tried_) return;
    Asking<Query> beside = asking;
    beside.drops = true;
    Counting not_counted;
    timed(beside_, [&] { tried_->run(slots, worker, not_counted, beside); });
  }
  const std::vector<ObjectPair>& pairs() const override { return answering_->pairs(); }
  std::size_t front_size() const override { return answering_->front_size(); }

  void count_posed(Counting& counter) override { answering_->count_posed(counter); }
  void see_fronts(
      const std::function<void(std::size_t, std::span<const NodePair>)>& see) const override {
    answering_->see_fronts(see);
  }
  std::array<std::size_t, 2> nodes() const override { return answering_->nodes(); }
  std::optional<ChoiceInTurn> choice() const override {
    const double built = from_->build_seconds() - built_before_;
    return ChoiceInTurn{trials_.reason(), built, std::max(0.0, 1e-9 * trials_.spent() - built)};
  }

 private:
  std::unique_ptr<Pairs> make(std::size_t k) {
    std::unique_ptr<Pairs> pairs(static_cast<Pairs*>(pairs_of(*from_, variants_[k]).release()));
    for (const TriangleMesh* mesh : added_) pairs->add(*mesh);
    return pairs;
  }
  template <class Do>
  void each(const Do& with) {
    with(*answering_);
    if (tried_) with(*tried_);
  }
  /// Adds to `sum`, in nanoseconds, what a part of a frame takes, if that is asked for.
  template <class Part>
  void timed(std::atomic<std::int64_t>& sum, const Part& part) {
    if (!is_timed_) return part();
    const auto start = Clock::now();
    part();
    sum += std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count();
  }

  /// Ends the last frame. Returns whether a trial begins with this one.
  bool begin_frame() {
    if (is_timed_) trials_.took(static_cast<double>(answered_), static_cast<double>(beside_));
    answered_ = beside_ = 0;
    if (tried_ && trials_.tried() != tried_number_) {
      if (trials_.current() == tried_number_) std::swap(answering_, tried_);
      tried_.reset();
    }
    trials_.next();
    const bool begins = trials_.tried() && !tried_;
    if (begins) begin_trial(*trials_.tried());
    is_timed_ = trials_.times();
    return begins && tried_;
  }
  /// Where there is no memory for another variant's trees, it is not tried.
  void begin_trial(std::size_t k) {
    const auto start = Clock::now();
    try {
      tried_ = make(k);
      const auto& pairs = answering_->pairs();
      // The last slot first: room for all is made at once.
      for (std::size_t slot = taken_.size(); slot-- > 0;)
        if (taken_[slot]) tried_->put(static_cast<std::uint32_t>(slot), pairs[slot]);
      tried_number_ = k;
      trials_.made(1e9 * seconds_since(start));
    } catch (const std::bad_alloc&) {
      tried_.reset();
      trials_.made(std::nullopt);
    }
  }

  Trials trials_;  // in nanoseconds
  std::shared_ptr<PairsFrom> from_;
  std::vector<Variant> variants_;
  std::unique_ptr<Pairs> answering_, tried_;
  std::size_t tried_number_ = 0;
  double built_before_ = 0;
  bool is_timed_ = false;
  std::atomic<std::int64_t> answered_ = 0, beside_ = 0;  // of this frame, all threads together
  std::vector<const TriangleMesh*> added_;
  std::vector<std::uint8_t> taken_, has_moved_;  // slots; bodies
};

}  // namespace bvlab::detail
