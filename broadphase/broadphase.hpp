// SPDX-License-Identifier: BSD-3-Clause
/// What a broad-phase method is, and THE list of them. A new one is a header under methods/ and a
/// line here; commands, tests and benchmarks walk the list.
#pragma once

#include <concepts>

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
#include "broadphase/settings.hpp"
#include "hierarchies/geometry/type_list.hpp"

namespace bvlab {

/// Finds which boxes of a frame overlap, frame after frame. Laws, checked by tests/laws for every
/// entry of `Methods`:
///   exactness    the pairs are those, and only those, that `overlap<Contact>` holds for;
///   uniqueness   each stands once, with i < j, contiguous; in the same order in every run;
///   freedom      frames may differ in anything: boxes may jump, appear and disappear;
///   steadiness   once frames stop growing, nothing is allocated.
/// Boxes must be free of faults (`first_fault`). The pairs stay valid until the next call. Made
/// with `Coherence::off`, a method forgets every frame, and keeps its memory.
template <class M>
concept BroadPhaseMethod = std::constructible_from<M, const MethodSettings&> &&
    requires(M method, Boxes<typename M::Scalar> boxes) {
  { M::name } -> std::convertible_to<std::string_view>;
  { M::description } -> std::convertible_to<std::string_view>;
  { method.overlapping(boxes) } -> std::same_as<std::span<const Pair>>;
};

/// A method that knows, made with `Changes::reported`, which pairs began and ended since the last
/// frame.
template <class M>
concept ReportsChanges = BroadPhaseMethod<M> && requires(const M method) {
  { method.changes() } -> std::same_as<PairChanges>;
};

// clang-format off
template <class T, class Contact = Closed>
using Methods = TypeList<
    Auto<T, Contact>,
    Blocks<T, Contact>,
    // the seed's
    Hybrid<T, Contact>,
    Hash<T, Contact>,
    Sweep1<T, Contact>,
    Sweep2<T, Contact>,
    Sweep3<T, Contact>,
    Sweep4<T, Contact>,
    // the field's
    SortAndSweep<T, Contact>,
    Sap<T, Contact>,
    Grid<T, Contact>,
    DynamicTree<T, Contact>,
    Lbvh<T, Contact>,
    BruteForce<T, Contact>
  >;
// clang-format on

}  // namespace bvlab
