// SPDX-License-Identifier: BSD-3-Clause
/// How coherent a motion is, apart from any strategy that could make use of it.
///
/// Three measures, all of pairs that are near (whose roots could not be told apart in this frame or
/// the one before):
///
///   survival   kept / entries: the share of the recursive front that is there in the next frame
///   stillness  still_runs / near_runs: how often nothing of it had to be descended, which is what
///              the talk's lists predict from
///   motion     how far the two bodies can have moved relative to each other since the frame before
///              (translations plus 2 sin(angle / 2) radius), in units of a leaf's size, and as a
///              share of the gap between them, at most 1
///
/// The talk tells steps apart by where the recursion stops (li1998incremental): a step is `still`
/// where this frame's front is the last one's, `down` where it lies at or below it, `up` where it
/// lies at or above it, and `mixed` where it does both. A list that never shrinks makes `again`
/// tests. One that may shrink also tries the parent of siblings that all stay, and tries on where
/// that parent is apart: `raised`. Runs that a hit cut short, now or in the frame before, are no
/// steps, and no part of two runs.
///
/// Two runs are such that a list from the front before them grew in neither; each is named by its
/// step. In the run after them the list may be kept or rebuilt.
///
/// What is counted is sums, so that parts of a trace, and traces, add up.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "experiments/replay/replay.hpp"

namespace bvlab {

enum class Step { still, down, up, mixed };
inline constexpr std::array<const char*, 4> step_names{"still", "down", "up", "mixed"};

/// Of the runs that make one kind of step.
struct StepSums {
  std::uint64_t runs = 0;
  std::uint64_t entries = 0;  ///< entries of the last frame's front
  std::uint64_t tests = 0;    ///< of pairs of volumes, from the roots
  std::uint64_t again = 0;    ///< the same, of a run through the last front
  std::uint64_t raised = 0;   ///< the same, where that front may also shrink
};

/// Of the runs after two without growth.
struct TwoRunSums {
  std::uint64_t runs = 0;
  std::uint64_t kept = 0;     ///< tests of pairs of volumes, by the list
  std::uint64_t rebuilt = 0;  ///< the same, from the roots
};

/// The two runs that grow no list: what is still at first can then only stay or come up.
struct TwoRuns {
  Step first, second;
};
inline constexpr std::array<TwoRuns, 6> two_runs{{{Step::up, Step::up},
                                                  {Step::up, Step::still},
                                                  {Step::up, Step::down},
                                                  {Step::up, Step::mixed},
                                                  {Step::still, Step::up},
                                                  {Step::still, Step::still}}};

struct CoherenceSums {
  std::uint64_t pair_runs = 0;      ///< pairs times frames, without the first
  std::uint64_t near_runs = 0;      ///< of these, near; all that follows is of them
  std::uint64_t moved_runs = 0;     ///< in which a body of the pair had moved
  std::uint64_t still_runs = 0;     ///< in which the last front, run through again, did not grow
  std::uint64_t tests = 0;          ///< of pairs of volumes, from the roots
  std::uint64_t entries = 0;        ///< entries of the last frame's front
  std::uint64_t kept = 0;           ///< of these, entries of this frame's front
  std::uint64_t grown = 0;          ///< entries more, after running through the last frame's
  std::uint64_t again = 0;          ///< tests of pairs of volumes that this running through took
  std::uint64_t still_entries = 0;  ///< entries of those last fronts that did not grow
  double motion_leaf = 0;           ///< sum of motions, in leaf sizes
  double motion_gap = 0;            ///< sum of motions as shares of the gap
  std::array<StepSums, 4> steps;    ///< by Step
  std::array<TwoRunSums, 6> two;    ///< by place in two_runs

  /// The share of a front that the next frame finds again; nothing where no pair was near another.
  std::optional<double> survival() const {
    if (entries == 0) return std::nullopt;
    return static_cast<double>(kept) / static_cast<double>(entries);
  }
};

/// For the variant's volume, query, build and leaf size; its strategy does not matter. The size of
/// a leaf is half the mean of its triangle's longest edge.
/// `waiting` is called for each pair; what it throws ends the work.
CoherenceSums coherence(
    std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant,
    const std::function<void()>& waiting = [] {});

/// What a separation list costs at best, see best_rebuilds.hpp: all pairs together.
struct BestRebuilds {
  std::uint64_t tests = 0;     ///< of pairs of volumes
  std::uint64_t rebuilds = 0;  ///< the first included
};

/// For the variant's volume, query (touching or contacts), build and leaf size. Takes O(frames^2)
/// runs per pair.
BestRebuilds best_rebuilds(std::span<const TriangleMesh> meshes, const Trace& trace,
                           const Variant& variant);

}  // namespace bvlab
