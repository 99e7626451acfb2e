// SPDX-License-Identifier: BSD-3-Clause
/// Configurations that have a name: volume, tree, build, fit, leaf size and strategy at once, for
/// those who do not want to choose.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/replay/registry.hpp"
#include "hierarchies/fitting.hpp"

namespace bvlab {

/// THE list, each with what it is.
std::vector<Named> configurations();

/// Throws Unusable for a parameter that is set beside a configuration which sets it, too.
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
/// played with trees that the replay can go on with, by the candidates that may pay, with a broad
/// phase where the replay will use one. O(triangles) where the motion is null.
struct Chosen {
  Variant variant;
  std::string reason;
  double seconds = 0;  ///< that the choice took, without the trees of what was chosen
  std::shared_ptr<KeptTrees> trees{};  ///< those of what was chosen, for ReplayOptions
};
Chosen configured(Variant variant, std::string_view configuration,
                  std::span<const TriangleMesh> meshes, const Trace* trace = nullptr,
                  BroadPhase broad_phase = BroadPhase::off);

/// What a run of `recommended` in unknown motion is to change to once it has taken twice as long as
/// that takes to build: oriented boxes, which fit long triangles, and others do not. Nothing where
/// triangles are about as long as wide.
struct LaterChoice {
  Variant variant;
  double build_seconds;
};
std::optional<LaterChoice> later_choice(const Variant& variant,
                                        std::span<const TriangleMesh> meshes);

}  // namespace bvlab
