// SPDX-License-Identifier: BSD-3-Clause
/// A trace out of numbers in memory.
#pragma once

#include <string>
#include <vector>

#include "experiments/scenes/trace.hpp"

namespace bvlab {

/// `values` in C order, shape (frames, objects, 7). Refuses with Unusable what `read_trace` does;
/// Messages name the file by `name`.
Trace checked_trace(std::size_t frames, std::size_t objects, std::vector<double> values,
                    const std::string& name);

}  // namespace bvlab
