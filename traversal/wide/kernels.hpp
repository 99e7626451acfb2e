// SPDX-License-Identifier: BSD-3-Clause
/// THE list of kernels. A kernel defines one step of a traversal of two wide trees.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/wide/mixed_kernel.hpp"
#include "traversal/wide/siblings_kernel.hpp"

namespace bvlab {

using Kernels = TypeList<SiblingsKernel, MixedKernel>;

}  // namespace bvlab
