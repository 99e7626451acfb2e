// SPDX-License-Identifier: BSD-3-Clause
/// Configurations that have a name: volume, tree, build, fit, leaf size and strategy at once, for
/// those who do not want to choose.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/replay/registry.hpp"

namespace bvlab {

/// THE list, each with what it is.
std::vector<Named> configurations();

/// The variant with what the configuration says of it under the variant's query; what it does not
/// say (query, precision, relative error) stays. Throws Unusable where there is none of that name.
/// `recommended` is then what is best for meshes whose triangles are about as long as wide.
Variant configured(Variant variant, std::string_view configuration);

/// The same for these meshes, on which `recommended` depends, and why it is so: a sentence, empty
/// where there is no choice.
struct Chosen {
  Variant variant;
  std::string reason;
};
Chosen configured(Variant variant, std::string_view configuration,
                  std::span<const TriangleMesh> meshes);

}  // namespace bvlab
