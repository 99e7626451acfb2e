// SPDX-License-Identifier: BSD-3-Clause
/// THE list of broad-phase methods. A new method is a header under methods/ and a line here (its
/// interface: broad_phase_method.hpp); commands, tests and benchmarks iterate over the list.
#pragma once

#include "broadphase/broad_phase_method.hpp"
#include "broadphase/methods/auto.hpp"
#include "broadphase/methods/blocks.hpp"
#include "broadphase/methods/brute_force.hpp"
#include "broadphase/methods/dynamic_tree.hpp"
#include "broadphase/methods/grid.hpp"
#include "broadphase/methods/hash.hpp"
#include "broadphase/methods/hybrid.hpp"
#include "broadphase/methods/lbvh.hpp"
#include "broadphase/methods/sap.hpp"
#include "broadphase/methods/sort_and_sweep.hpp"
#include "broadphase/methods/sweep.hpp"
#include "hierarchies/geometry/type_list.hpp"

namespace bvlab {

// clang-format off
template <class T, class Contact = Closed>
using Methods = TypeList<
    Auto<T, Contact>,
    Blocks<T, Contact>,
    // koziara2005bounding
    Hybrid<T, Contact>,
    Hash<T, Contact>,
    Sweep1<T, Contact>,
    Sweep2<T, Contact>,
    Sweep3<T, Contact>,
    Sweep4<T, Contact>,
    // other methods from the literature
    SortAndSweep<T, Contact>,
    Sap<T, Contact>,
    Grid<T, Contact>,
    DynamicTree<T, Contact>,
    Lbvh<T, Contact>,
    BruteForce<T, Contact>
  >;
// clang-format on

}  // namespace bvlab
