// SPDX-License-Identifier: BSD-3-Clause
/// Tests that decide pairs of bodies before any tree is traversed, a register of pairs at a time:
/// spheres around the bodies, and directions that separate them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "traversal/shape.hpp"
#include "traversal/wide/separating_direction.hpp"

namespace bvlab {

/// A set of pairs of bodies, by their indices, each of them undecided or decided (to be apart, or
/// to have its last answer). One sieve per thread.
class PairSieve {
 public:
  using Indices = SeparatingDirections::Indices;
  static constexpr std::size_t width = SeparatingDirections::width;

  /// Empties the sieve and reserves `pairs` pairs, plus one register.
  void begin(std::size_t pairs) {
    if (decided_.size() < pairs + width)
      undecided_.resize(pairs + width), decided_.resize(pairs + width);
    undecided_count_ = decided_count_ = 0;
  }
  void add(std::uint32_t pair) { undecided_[undecided_count_++] = static_cast<std::int32_t>(pair); }
  std::span<const std::int32_t> undecided() const {
    return std::span(undecided_).first(undecided_count_);
  }
  std::span<const std::int32_t> decided() const {
    return std::span(decided_).first(decided_count_);
  }

  /// Decides the pairs for which `decides(pair)` is true, one at a time.
  template <class Decides>
  void sift(Decides&& decides) {
    sift_deferred([&](std::size_t p) { put(static_cast<std::int32_t>(p), !decides(p)); });
  }
  /// Calls `take(pair)` for each undecided pair. `take` may call `put` for a pair later, and in any
  /// order: results overwrite only pairs that have been read.
  template <class Take>
  void sift_deferred(Take&& take) {
    const std::size_t count = std::exchange(undecided_count_, 0);
    for (std::size_t k = 0; k < count; ++k) take(at(k));
  }
  void put(std::int32_t pair, std::size_t is_undecided) {
    undecided_[undecided_count_] = decided_[decided_count_] = pair;
    undecided_count_ += is_undecided, decided_count_ += 1 - is_undecided;
  }

  /// Tests pairs a register at a time: `test(pairs, used)` returns the bits of those that remain
  /// undecided. Pairs for which `skips(pair)` is true are not tested and remain undecided. Returns
  /// the number of tests.
  template <class Skips, class Test>
  std::size_t sift_batches(Skips&& skips, Test&& test) {
    std::size_t skipped = 0;
    for (std::size_t k = 0; k < undecided_count_; ++k)
      if (skips(at(k))) std::swap(undecided_[k], undecided_[skipped++]);
    const std::size_t count = std::exchange(undecided_count_, skipped);
    for (std::size_t k = skipped; k < count; k += width) {
      const Indices pairs(&undecided_[k], stdx::element_aligned);
      const std::size_t used = std::min(width, count - k);
      const std::uint64_t stay = test(pairs, used);
      alignas(64) std::array<std::int32_t, width> pair;
      pairs.copy_to(pair.data(), stdx::vector_aligned);
      for (std::size_t lane = 0; lane < used; ++lane) put(pair[lane], stay >> lane & 1);
    }
    return count - skipped;
  }

 private:
  std::size_t at(std::size_t k) const { return static_cast<std::size_t>(undecided_[k]); }

  std::vector<std::int32_t> undecided_, decided_;
  std::size_t undecided_count_ = 0, decided_count_ = 0;
};

class EarlyCulling {
 public:
  using Indices = PairSieve::Indices;

  /// Adds the next body, by the support map of its mesh, which may be empty until `make_maps`.
  /// Bodies of one mesh share one copy; returns whether this is the first of them.
  bool add_body(const SupportMap& map) {
    const auto [known, fresh] = added_.try_emplace(&map, 0);
    if (fresh) known->second = directions_.add(map);
    maps_.push_back(known->second), of_body_.push_back(&map);
    directions_.resize(maps_.size());
    return fresh;
  }

  /// Makes maps that were empty when they were added: `made(k)` has the table of empty[k].
  template <class Made>
  void make_maps(std::span<const SupportMap* const> empty, Made&& made) {
    for (std::size_t k = 0; k < empty.size(); ++k) added_.at(empty[k]) = directions_.add(made(k));
    for (std::size_t body = 0; body < maps_.size(); ++body) {
      maps_[body] = added_.at(of_body_[body]);
      directions_.set_map(body, maps_[body]);
    }
  }

  /// `centre`: the sphere's, from the common origin; `error_bound`: as in OrthonormalPose.
  void set_pose(std::size_t body, const Mat3<double>& rotation, const Vec3<double>& centre,
                double radius, double error_bound) {
    directions_.set_pose(body, maps_[body], rotation, centre, radius, error_bound);
  }

  /// Decides pairs whose spheres are apart.
  void cull_by_spheres(PairSieve& sieve, std::span<const ObjectPair> pairs) const {
    sieve.sift_batches([](std::size_t) { return false; },
                       [&](const Indices& numbers, std::size_t used) {
                         return directions_.spheres_meet(pairs_of(pairs, numbers, used));
                       });
  }

  /// Decides pairs that a direction separates; calls `apart(pair, gap)` for each, with a lower
  /// bound on its distance. If `skips(pair)`, it remains undecided. Returns the number tested.
  template <class Skips, class Apart>
  std::size_t cull_by_directions(PairSieve& sieve, std::span<const ObjectPair> pairs, Skips&& skips,
                                 Apart&& apart) const {
    return sieve.sift_batches(skips, [&](const Indices& numbers, std::size_t used) {
      const auto batch = pairs_of(pairs, numbers, used);
      const auto gaps =
          directions_.gaps(batch, SeparatingDirections::normalized(batch.between), most_directions);
      const std::uint64_t near = ~bits(gaps > 0.0f);
      for (std::size_t lane = 0; lane < used; ++lane)
        if (!(near >> lane & 1)) apart(static_cast<std::size_t>(numbers[lane]), gaps[lane]);
      return near;
    });
  }

 private:
  static constexpr int most_directions = 2;

  /// The first `used` of these pairs, one a lane; the other lanes repeat pair 0.
  SeparatingDirections::Pairs pairs_of(std::span<const ObjectPair> pairs, const Indices& numbers,
                                       std::size_t used) const {
    constexpr int width = static_cast<int>(PairSieve::width);
    Indices offset = 2 * numbers;
    const Indices lanes([](auto lane) { return static_cast<std::int32_t>(lane); });
    stdx::where(lanes >= static_cast<std::int32_t>(used), offset) = 0;
    const auto body = [&](const std::uint32_t& first) {
      return std::bit_cast<Indices>(
          gathered<width>(reinterpret_cast<const float*>(&first), offset));
    };
    return directions_.pairs(body(pairs[0].i), body(pairs[0].j));
  }

  SeparatingDirections directions_;
  std::map<const SupportMap*, std::int32_t> added_;
  // For each body, its map, and the number of that in directions_.
  std::vector<const SupportMap*> of_body_;
  std::vector<std::int32_t> maps_;
};

}  // namespace bvlab
