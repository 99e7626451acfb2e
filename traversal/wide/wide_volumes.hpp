// SPDX-License-Identifier: BSD-3-Clause
/// THE list of volumes that the program has in wide trees. Any of volumes.hpp may be added, and is
/// then compiled under every query; a volume with a facing of its own has it in
/// hierarchies/wide/<volume>_facing.hpp.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "hierarchies/wide/slab_box_facing.hpp"

namespace bvlab {

using WideVolumes = TypeList<SlabBox<float>>;

}  // namespace bvlab
