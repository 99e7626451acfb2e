// SPDX-License-Identifier: BSD-3-Clause
/// The tree that a variant asks for, apart from its volumes: compiled once for all of them.
#pragma once

#include "experiments/replay/replay.hpp"
#include "hierarchies/build/topology.hpp"

namespace bvlab {

/// By the variant's build and leaf size; their names have been checked.
Topology topology_of(const TriangleMesh& mesh, const Variant& variant);

}  // namespace bvlab
