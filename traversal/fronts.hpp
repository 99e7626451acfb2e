// SPDX-License-Identifier: BSD-3-Clause
/// The fronts of the strategies in strategies.hpp. The bvlab program compiles each volume's loops
/// for all of these together. A strategy with another kind of front declares it (`using OwnFronts =
/// TypeList<...>`); loops from that front are compiled separately for each volume.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/front.hpp"
#include "traversal/no_front.hpp"
#include "traversal/strategies/margin_sweep.hpp"
#include "traversal/strategies/rising_front.hpp"
#include "traversal/strategies/witness.hpp"

namespace bvlab {

using Fronts = TypeList<NoFront, NoFrontBoth, WitnessedRoots, Front, RisingFront, MarginSweep>;

}  // namespace bvlab
