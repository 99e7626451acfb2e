// SPDX-License-Identifier: BSD-3-Clause
/// How many volumes there are to pose: what a report of skipped work is measured by.
#pragma once

#include "experiments/runner/replay.hpp"

namespace bvlab {

/// The number of nodes of the variant's hierarchy over a mesh.
std::size_t hierarchy_size(const TriangleMesh& mesh, const Variant& variant);

}  // namespace bvlab
