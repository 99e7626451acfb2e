// SPDX-License-Identifier: BSD-3-Clause
/// THE list of bounding volumes: one include and one line each. Programs are compiled one volume
/// at a time, so keep one entry a line.
#pragma once

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/geometry/type_list.hpp"
#include "hierarchies/volumes/kdop.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/volumes/rss.hpp"
#include "hierarchies/volumes/shell.hpp"
#include "hierarchies/volumes/slab_box.hpp"
#include "hierarchies/volumes/sphere.hpp"

namespace bvlab {

using Volumes = TypeList<  //
    Sphere<float>,         //
    Obb<float>,            //
    Aabb<float>,           //
    Kdop14<float>,         //
    Kdop18<float>,         //
    Kdop26<float>,         //
    Rss<float>,            //
    Shell<float>,          //
    SlabBox<float>>;

}  // namespace bvlab
