// SPDX-License-Identifier: BSD-3-Clause
/// A replay in parts, one a thread: what of it does not depend on volume, strategy and query.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "experiments/replay/replay.hpp"
#include "traversal/body_pair.hpp"

namespace bvlab {

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

namespace detail {

/// One thread's share of a replay.
class Share {
 public:
  virtual ~Share() = default;
  virtual void play() = 0;
  /// Adds what was found and counted.
  virtual void hand_over(ReplayResult& result) = 0;
};

/// Makes the share of every `stride`-th pair from the `first` on.
using MakeShare =
    std::function<std::unique_ptr<Share>(std::size_t first, std::size_t stride, ReplayResult&)>;

/// Every `stride`-th pair of `objects` objects from the `first` on.
std::vector<ObjectPair> share_of_pairs(std::size_t objects, std::size_t first, std::size_t stride);

/// Plays all shares, one a thread, and puts together what they found.
void play_shares(const Trace& trace, const ReplayOptions& options, const MakeShare& make,
                 ReplayResult& result);

}  // namespace detail

}  // namespace bvlab
