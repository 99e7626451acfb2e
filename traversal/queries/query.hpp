// SPDX-License-Identifier: BSD-3-Clause
/// What a query has to offer.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <string_view>

#include "traversal/queries/candidate.hpp"

namespace bvlab {

/// A query says which pairs of volumes need no further look, and takes the primitives of the rest.
///   culls(p, q)           a mask over posed volumes p of body a and q of body b; where no bound is
///                         wanted, a matter of the volumes alone
///   primitives(pending)   takes one candidate or more; says whether the traversal can end
///   buffer_size           the most candidates that are held back before `primitives` is called
///   wants_bound           if there and true: one pair of near leaves is handed over first, near
///                         pairs are looked at before far ones, and `culls(gap)` says the same
/// The bvlab program makes it by `asked(options)` and takes `answer()`, true or false or a number;
/// or makes it by `asked(options, found)`, and it appends pairs of primitives to `found`. And for
/// strategies that keep margins:
///   primitives(pending, verdicts)   the same, saying of each candidate what was found
///   limit()                         surfaces farther apart than this matter to the query no more
///   known(a, b)                     two triangles still share a point; says whether that is enough
template <class Q, class P>
concept Query = requires(Q query, const P& p, std::span<const Candidate> pending) {
  { Q::name } -> std::convertible_to<std::string_view>;
  { Q::description } -> std::convertible_to<std::string_view>;
  query.culls(p, p);
  { query.primitives(pending) } -> std::same_as<Outcome>;
  { Q::buffer_size } -> std::convertible_to<std::size_t>;
};

template <class Q>
constexpr bool wants_bound() {
  if constexpr (requires { Q::wants_bound; }) return Q::wants_bound;
  return false;
}

}  // namespace bvlab
