// SPDX-License-Identifier: BSD-3-Clause
/// Configurations that have a name: volume, tree, build, fit, leaf size and strategy at once, for
/// those who do not want to choose.
#pragma once

#include <string_view>
#include <vector>

#include "experiments/replay/registry.hpp"

namespace bvlab {

/// THE list, each with what it is.
std::vector<Named> configurations();

/// The variant with what the configuration says of it under the variant's query; what it does not
/// say (query, precision, relative error) stays. Throws Unusable where there is none of that name.
Variant configured(Variant variant, std::string_view configuration);

}  // namespace bvlab
