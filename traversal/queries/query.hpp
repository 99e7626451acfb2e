// SPDX-License-Identifier: BSD-3-Clause
/// The concept of a query between two bodies.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <string_view>

#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// A query decides which pairs of volumes are culled, and tests the primitives of the rest.
///   culls(p, q)           a mask over posed volumes p of body a and q of body b; unless the query
///                         wants a bound, it depends on the volumes alone
///   primitives(pending)   tests one candidate or more; its outcome: is the query satisfied?
///   culls_disjoint        if present and true: `culls(p, q)` is `disjoint(p, q)`. Wide trees cull
///                         disjoint pairs and bodies, and never call `culls(p, q)`: they answer
///                         only such queries, and those that want a bound
///   buffer_size           once more candidates than this are held, `primitives` is called
///   one_hit_is_enough     whether one pair of triangles that share a point can end the query; if
///                         not, and it wants no bound, hits must not satisfy it: it finds them all
///   wants_bound           if present and true: one pair of near leaves is tested first, near pairs
///                         are tested before far ones, and `culls(gap)` decides the same
/// The bvlab program makes a query by `from_options(options)` and reads `answer()`, a bool or a
/// number; or makes it by `from_options(options, found)`, and the query appends pairs of primitives
/// to `found`.
///
/// A bool `answer()` of a query that one hit can end is true exactly if a hit was found.
///
/// For strategies that keep margins:
///   primitives(pending, verdicts)   the same, with a verdict on each candidate. Only hits may
///                                   satisfy a query that has no repeat()
///   limit()                         surfaces farther apart than this no longer matter to the query
///   known(a, b)                     triangles a and b share a point (found now, or still valid);
///                                   returns whether that satisfies the query. A query answered by
///                                   yes or no must ignore a and b: a repeated answer has others
///   nearest(), repeat(nearest)      for queries answered by a distance: it and the triangles that
///                                   have it; sets what an earlier query found
template <class Q, class P>
concept Query = requires(Q query, const P& p, std::span<const Candidate> pending) {
  { Q::name } -> std::convertible_to<std::string_view>;
  { Q::description } -> std::convertible_to<std::string_view>;
  query.culls(p, p);
  { query.primitives(pending) } -> std::same_as<Outcome>;
  { Q::buffer_size } -> std::convertible_to<std::size_t>;
  { Q::one_hit_is_enough } -> std::convertible_to<bool>;
};

template <class Q>
constexpr bool wants_bound() {
  if constexpr (requires { Q::wants_bound; }) return Q::wants_bound;
  return false;
}

/// A query that wide trees can answer.
template <class Q>
constexpr bool for_wide_trees() {
  if constexpr (requires { Q::culls_disjoint; })
    if (Q::culls_disjoint) return true;
  return wants_bound<Q>();
}

/// A query whose answer is yes or no.
template <class Q>
concept AnswersYesOrNo = requires(const Q& query) {
  { query.answer() } -> std::same_as<bool>;
};
/// A query that a single hit decides.
template <class Q>
concept DecidedByOneHit = Q::one_hit_is_enough && !wants_bound<Q>();
template <class Q>
concept YesOrNoByOneHit = AnswersYesOrNo<Q> && DecidedByOneHit<Q>;
/// A query that looks for all hits.
template <class Q>
concept FindsAllHits = !Q::one_hit_is_enough && !wants_bound<Q>();

}  // namespace bvlab
