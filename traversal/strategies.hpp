// SPDX-License-Identifier: BSD-3-Clause
/// THE list of strategies: how a pair of bodies is queried from frame to frame.
///
/// A strategy belongs to one pair of bodies and lives as long as the pair. It is default
/// constructible, and has
///   name, description   as texts;
///   run(pair)      answers the pair's query for the bodies' current poses (see body_pair.hpp);
///   front_size()   the number of entries it keeps.
/// After an exception in `run` a new strategy takes its place. It is copy-assignable for that.
/// Law: after every run, whatever happened between runs, the query holds the answer that
/// `Recursive` gives; a distance within 2^-45 of it (distance.hpp).
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/strategies/adaptive.hpp"
#include "traversal/strategies/by_cost.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/raise.hpp"
#include "traversal/strategies/recursive.hpp"
#include "traversal/strategies/separation_list.hpp"
#include "traversal/strategies/witness.hpp"

namespace bvlab {

using Strategies = TypeList<Recursive, RecursiveBoth, Witness, SeparationList, Deferred, ByCost,
                            Raise, Margins, Adaptive>;

}  // namespace bvlab
