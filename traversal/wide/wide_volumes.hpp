// SPDX-License-Identifier: BSD-3-Clause
/// THE list of volumes that the bvlab program offers in wide trees. Any volume of volumes.hpp may
/// be added, and is then compiled for every query. A volume's own sibling test is in
/// hierarchies/wide/<volume>_sibling_test.hpp.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "hierarchies/wide/obb_sibling_test.hpp"
#include "hierarchies/wide/slab_box_sibling_test.hpp"

namespace bvlab {

using WideVolumes = TypeList<SlabBox<float>, Obb<float>>;

}  // namespace bvlab
