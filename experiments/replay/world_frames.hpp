// SPDX-License-Identifier: BSD-3-Clause
/// A trace played through a whole scene's engine, ours or another library's: it is told which
/// bodies moved and then says which pairs touch. Finding out who moved is no part of the time,
/// since an application knows; telling is.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "experiments/replay/replay.hpp"
#include "traversal/all_pairs.hpp"

namespace bvlab {

class WorldEngine {
 public:
  virtual ~WorldEngine() = default;
  /// Only these pairs are asked about; to be called before the first update. Ours alone can.
  virtual void choose(const PairChoice&) {}
  /// Every body is moved before the first update; ours may come later.
  virtual void move(std::uint32_t object, const Pose& pose) = 0;
  virtual void update() = 0;
  /// After `update`: the pairs that touch, i < j, in any order.
  virtual std::span<const ObjectPair> touching() = 0;

  /// After `update`, where it is known: pairs whose boxes meet, pairs queried.
  virtual std::size_t near() const { return 0; }
  virtual std::size_t queried() const { return 0; }

  // Ours alone can:
  /// Adds a body of that mesh, which must outlive the world; it enters the scene when it is moved.
  virtual void add(const TriangleMesh&) {}
  /// Removes a body from the scene, until it is moved again.
  virtual void remove(std::uint32_t) {}
};

struct WorldRun {
  double build_seconds = 0, first_seconds = 0;
  double seconds = 0;                                          ///< all frames but the first
  std::uint64_t near = 0, queried = 0, touching = 0, moved = 0;  ///< sums over the same frames
  std::vector<std::vector<ObjectPair>> answers;  ///< of each frame, sorted; where they are kept
};

enum class Answers : std::uint8_t { counted, kept };

/// Object i uses mesh i mod meshes.size().
WorldRun play_frames(WorldEngine& world, const Trace& trace, Answers answers);

/// How many answers differ from those of the reference: pairs that only one of them has.
std::size_t differing(const WorldRun& run, const WorldRun& reference);

}  // namespace bvlab
