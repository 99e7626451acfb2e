// SPDX-License-Identifier: BSD-3-Clause
/// Configurations that have a name: volume, tree, build, fit, leaf size and strategy at once, for
/// those who do not want to choose.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/replay/registry.hpp"
#include "hierarchies/fitting.hpp"

namespace bvlab {

/// THE list, each with what it is.
std::vector<Named> configurations();

/// The parameters that a configuration sets.
inline constexpr std::string_view set_by_configuration[] = {
    "volume", "strategy", "build", "leaf_size", "fit", "fan_out", "frame", "kernel"};
/// Throws Unusable for one of them that is set beside a configuration.
[[noreturn]] void refuse_beside_configuration(std::string_view parameter);

/// The variant with what the configuration says of it under the variant's query; what it does not
/// say (query, precision, relative error) stays. Throws Unusable where there is none of that name.
/// `recommended` is then what is best for meshes whose triangles are about as long as wide.
Variant configured(Variant variant, std::string_view configuration);

/// A configuration of the library (traversal/recommended.hpp and the like) as a variant.
template <class Best>
Variant variant_of(Variant variant) {
  set_kernel(variant, Best::Kernel::name);
  variant.volume = Best::Volume::name, variant.strategy = Best::Memory::name;
  variant.build = Best::Build::name, variant.leaf_size = Best::leaf_size;
  variant.fit = name_of(Best::fit);
  return variant;
}

/// The same for these meshes and, where it is known, their motion: `recommended` depends on both.
/// With the reason, a sentence that is empty where there is no choice. Samples of the motion are
/// played, by as many hierarchies as there are candidates, with a broad phase where the replay will
/// use one. O(triangles) where the motion is null.
struct Chosen {
  Variant variant;
  std::string reason;
  double seconds = 0;  ///< that the choice took
};
Chosen configured(Variant variant, std::string_view configuration,
                  std::span<const TriangleMesh> meshes, const Trace* trace = nullptr,
                  BroadPhase broad_phase = BroadPhase::off);

}  // namespace bvlab
