// SPDX-License-Identifier: BSD-3-Clause
/// What a broad-phase method is, and the laws it keeps.
#pragma once

#include <concepts>
#include <span>
#include <string_view>

#include "broadphase/settings.hpp"

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

/// A method that can be told which boxes moved: `update` gives what `overlapping` does, where no
/// box but those told, and new ones, differs from the last frame. An index may stand there twice,
/// or though its box did not move.
template <class M>
concept TakesMoved = BroadPhaseMethod<M> && requires(M method, Boxes<typename M::Scalar> boxes,
                                                     std::span<const std::uint32_t> moved) {
  { method.update(boxes, moved) } -> std::same_as<std::span<const Pair>>;
};

}  // namespace bvlab
