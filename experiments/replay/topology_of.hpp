// SPDX-License-Identifier: BSD-3-Clause
/// The tree that a variant asks for, apart from its volumes: compiled once for all of them.
#pragma once

#include "experiments/replay/replay.hpp"
#include "hierarchies/build/topology.hpp"
#include "hierarchies/wide/collapse.hpp"

namespace bvlab {

/// By the variant's build and leaf size; their names have been checked. Binary, whatever the
/// variant's fan-out.
Topology topology_of(const TriangleMesh& mesh, const Variant& variant);
/// The same with nodes of the variant's fan-out.
WideTopology wide_topology_of(const TriangleMesh& mesh, const Variant& variant);
/// How many nodes it has.
std::size_t nodes_of(const TriangleMesh& mesh, const Variant& variant);

}  // namespace bvlab
