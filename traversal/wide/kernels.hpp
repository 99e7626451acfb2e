// SPDX-License-Identifier: BSD-3-Clause
/// THE list of kernels for wide trees. A kernel defines one step of a traversal of two of them;
/// siblings_kernel.hpp lists its members. Trees of any fan-out are also traversed by the gathered
/// kernel (gathered_kernel.hpp), which takes pairs of nodes from anywhere.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/wide/mixed_kernel.hpp"
#include "traversal/wide/siblings_kernel.hpp"

namespace bvlab {

using Kernels = TypeList<SiblingsKernel, MixedKernel>;

}  // namespace bvlab
