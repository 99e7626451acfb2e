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

/// Throws Unusable for a parameter that is set beside a configuration which sets it, too.
[[noreturn]] void refuse_beside_configuration(std::string_view parameter);

/// The variant with what the configuration says of it under the variant's query; what it does not
/// say (query, precision, relative error) stays. Throws Unusable where there is none of that name.
/// `recommended` says what a run begins with, and that it may go on with another.
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

/// What `recommended` may go on with, and begins with the first of.
struct Recommendation {
  Variant variant;
  std::string name;
  double build;          ///< of a triangle's share of the trees, in nanoseconds
  double in_frames = 0;  ///< the same of trees on demand, the most that frames spend on it
};
/// For a variant's query, in the order in which they are tried. O(triangles).
std::vector<Recommendation> recommendations(Variant variant, std::span<const TriangleMesh> meshes);

}  // namespace bvlab
