// SPDX-License-Identifier: BSD-3-Clause
/// THE list of volumes that the program has in wide trees. Any of volumes.hpp may be added, and is
/// then compiled under every query. A volume with a sibling test of its own has it in
/// hierarchies/wide/<volume>_sibling_test.hpp.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"

namespace bvlab {

using WideVolumes = TypeList<SlabBox<float>, Obb<float>>;

}  // namespace bvlab
