// SPDX-License-Identifier: BSD-3-Clause
/// What a broad-phase method is told when it is made.
#pragma once

#include <cstdint>
#include <span>

#include "broadphase/box.hpp"

namespace bvlab {

/// Whether a frame may use what the frames before it left behind.
enum class Coherence { off, on };

/// Whether the pairs that began and ended are reported besides all pairs.
enum class Changes { unreported, reported };

/// How ends are sorted from scratch: by the digits of their keys, O(n), or by comparing them,
/// O(n log n), as was usual when koziara2005bounding was written.
enum class Sort { radix, comparison };

struct MethodSettings {
  Coherence coherence = Coherence::on;
  Changes changes = Changes::unreported;
  int threads = 1;
  Sort sort = Sort::radix;      ///< of `hash`, the sweeps and `sort-and-sweep`
  std::uint32_t cutoff = 1000;  ///< where `hybrid` stops dividing and scans
};

/// The pairs of this frame that the last one had not, and the other way round; any order.
struct PairChanges {
  std::span<const Pair> began;
  std::span<const Pair> ended;
};

}  // namespace bvlab
