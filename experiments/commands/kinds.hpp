// SPDX-License-Identifier: BSD-3-Clause
/// The kinds of names that there are, and the names of each kind with what they are: what
/// `bvlab list` prints.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "experiments/replay/registry.hpp"

namespace bvlab {

struct Kind {
  std::string_view name;  ///< volumes, strategies, ...
  std::vector<Named> (*entries)();
};

std::span<const Kind> kinds();

/// Throws Unusable, naming the kinds, where there is none of that name.
const Kind& kind_of(std::string_view name);

}  // namespace bvlab
