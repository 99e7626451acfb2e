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

WideTopology wide_topology_of(const TriangleMesh& mesh, const Variant& variant) {
  return collapsed(mesh, topology_of(mesh, variant), variant.fan_out, 1);
}

std::size_t nodes_of(const TriangleMesh& mesh, const Variant& variant) {
  return variant.fan_out == 2 ? topology_of(mesh, variant).nodes.size()
                              : wide_topology_of(mesh, variant).nodes.size();
}

}  // namespace bvlab
