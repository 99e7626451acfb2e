// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/frames/frames_entry.hpp"

namespace bvlab {

std::span<const FramesEntry* const> frames_entries() { return {}; }

}  // namespace bvlab
