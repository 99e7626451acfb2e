// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/topology_of.hpp"

#include "hierarchies/builds.hpp"

namespace bvlab {

Topology topology_of(const TriangleMesh& mesh, const Variant& variant) {
  Topology topology;
  Builds::with(variant.build, [&]<class Build>(std::type_identity<Build>) {
    topology = Build::topology(mesh, variant.leaf_size);
  });
  return topology;
}

}  // namespace bvlab
