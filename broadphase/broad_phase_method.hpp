// SPDX-License-Identifier: BSD-3-Clause
/// The concept of a broad-phase method, and the laws that every method keeps.
#pragma once

#include <concepts>
#include <span>
#include <string_view>

#include "broadphase/settings.hpp"

namespace bvlab {

/// Finds the overlapping pairs of boxes in each frame of a sequence. Laws, checked by tests/laws
/// for every entry of `Methods`:
///   exactness    a pair is listed if and only if `overlap<Contact>` holds for it;
///   uniqueness   each pair is listed once, with i < j; the order is the same in every run;
///   freedom      successive frames are arbitrary: boxes may jump, appear and disappear;
///   steadiness   on one thread a frame allocates nothing once frames stop growing.
/// Boxes must be valid (see `first_fault`). The returned span is valid until the next call. With
/// `Coherence::off` a method uses nothing of earlier frames; it keeps only its buffers. After an
/// exception, which only an allocation throws, a method is not to be used again.
template <class M>
concept BroadPhaseMethod = std::constructible_from<M, const MethodSettings&> &&
                           requires(M method, Boxes<typename M::Scalar> boxes) {
                             { M::name } -> std::convertible_to<std::string_view>;
                             { M::description } -> std::convertible_to<std::string_view>;
                             { method.overlapping(boxes) } -> std::same_as<std::span<const Pair>>;
                           };

/// A method that knows which pairs began and ended since the last frame, if it is made with
/// `Changes::reported`.
template <class M>
concept ReportsChanges = BroadPhaseMethod<M> && requires(const M method) {
  { method.changes() } -> std::same_as<PairChanges>;
};

/// A method that accepts a list of the boxes that moved: `update` returns what `overlapping` would,
/// provided that all other boxes, except new ones, are as in the last frame. `moved` may list an
/// index twice, or list a box that did not move.
template <class M>
concept TakesMoved = BroadPhaseMethod<M> && requires(M method, Boxes<typename M::Scalar> boxes,
                                                     std::span<const std::uint32_t> moved) {
  { method.update(boxes, moved) } -> std::same_as<std::span<const Pair>>;
};

}  // namespace bvlab
