// SPDX-License-Identifier: BSD-3-Clause
/// Refuses threads that there are not.
#pragma once

#include "experiments/files/unusable.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

/// Throws Unusable where more than one is wanted and the program was built without TBB.
inline void require_threads(std::size_t threads) {
  if (threads > 1 && !Threads::available)
    throw Unusable("--threads", "only 1 is available: TBB was not found when bvlab was built");
}

}  // namespace bvlab
