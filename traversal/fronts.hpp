// SPDX-License-Identifier: BSD-3-Clause
/// The fronts that are not one strategy's own: the bvlab program compiles each volume's loops from
/// all of these, together. A strategy with a front of another kind says so (`using OwnFronts =
/// TypeList<...>`), and loops from that are compiled for each volume by themselves.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/front.hpp"
#include "traversal/no_front.hpp"
#include "traversal/strategies/margin_sweep.hpp"
#include "traversal/strategies/rising_front.hpp"

namespace bvlab {

using Fronts = TypeList<NoFront, NoFrontBoth, Front, RisingFront, MarginSweep>;

}  // namespace bvlab
