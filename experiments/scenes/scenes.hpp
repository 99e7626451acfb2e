// SPDX-License-Identifier: BSD-3-Clause
/// THE list of scenes.
#pragma once

#include "experiments/scenes/parts.hpp"
#include "experiments/scenes/pile.hpp"
#include "experiments/scenes/planner.hpp"
#include "experiments/scenes/random_walk.hpp"
#include "experiments/scenes/recorded.hpp"
#include "experiments/scenes/tori.hpp"
#include "hierarchies/geometry/type_list.hpp"

namespace bvlab {

using Scenes = TypeList<RandomWalk, Planner, Pile, Tori, Recorded, Parts>;

}  // namespace bvlab
