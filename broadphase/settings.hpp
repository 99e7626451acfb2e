// SPDX-License-Identifier: BSD-3-Clause
/// The settings with which a broad-phase method is constructed.
#pragma once

#include <cstdint>
#include <span>

#include "broadphase/box.hpp"

namespace bvlab {

/// Whether a method may use results of earlier frames.
enum class Coherence { off, on };

/// Whether a method also lists the pairs that began and ended.
enum class Changes { unreported, reported };

/// How ends are sorted from scratch: by the digits of their keys, O(n), or by comparing them,
/// O(n log n), as was usual when koziara2005bounding was written.
enum class Sort { radix, comparison };

struct MethodSettings {
  Coherence coherence = Coherence::on;
  Changes changes = Changes::unreported;
  int threads = 1;              ///< used by `auto` and `blocks`
  Sort sort = Sort::radix;      ///< used by `hash`, the sweeps and `sort-and-sweep`
  std::uint32_t cutoff = 1000;  ///< below so many boxes `hybrid` scans
};

/// Pairs that overlap in this frame but not in the last, and vice versa; in any order.
struct PairChanges {
  std::span<const Pair> began;
  std::span<const Pair> ended;
};

}  // namespace bvlab
