// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/hierarchy_size.hpp"

#include "hierarchies/builds.hpp"

namespace bvlab {

std::size_t hierarchy_size(const TriangleMesh& mesh, const Variant& variant) {
  std::size_t nodes = 0;
  Builds::with(variant.build, [&]<class Build>(std::type_identity<Build>) {
    nodes = Build::topology(mesh, variant.leaf_size).nodes.size();
  });
  return nodes;
}

}  // namespace bvlab
