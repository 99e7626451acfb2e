// SPDX-License-Identifier: BSD-3-Clause
/// What a front has to offer, so that the loop can start from it and keep it up to date.
///
/// The front (the talk's separation list) is where the last recursion stopped: the pairs of nodes
/// that were culled, and the pairs of leaves. What is kept of a pair, which of them a run looks at,
/// in which order, and what is opened besides is all a front's own matter.
///
/// Law: in every run the entries looked at, and what is known of the others, settle the query; and
/// the entries partition the product of the two bodies' leaves, so that every pair of leaves lies
/// below exactly one. A front that keeps nothing (NoFront) starts from the roots.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "traversal/descent.hpp"
#include "traversal/node_pair.hpp"
#include "traversal/queries/candidate.hpp"
#include "traversal/workspace.hpp"

namespace bvlab {

/// What a traversal had to do.
struct TraversalStatistics {
  bool everything = true;     ///< false where the query stopped it
  std::size_t volumes = 0;    ///< pairs of volumes tested
  std::size_t triangles = 0;  ///< pairs of primitives tested
};

/// What a run has found out about an entry.
enum class Seen {
  culled,  ///< its volumes need no further look; their gap is known where gaps are measured
  near,    ///< they do, and both are leaves, whose primitives are tested unless a hit ends the run
  not_yet  ///< nothing, or not all: the run has ended before
};

/// The members, of which FrontDefaults has those that a simple front need not care about. A slot is
/// the number under which the front knows an entry.
///   sweep(traversal)         has entries looked at, by Traversal::look_at; says whether the query
///                            has had enough
///   front[slot]              the pair
///   stays(slot, seen, gap)   an entry looked at stays one: it has survived, if it was culled
///   open(slot)               it does not: the next pair that is added, of at least two, takes its
///                            place
///   add(pair, seen, gap)     the pair is an entry now; says in which slot
///   finish(witness, enough)  the run is over, ended by the query or not; `witness` is the slot of
///                            the entry in which the query found what is worth testing first next
///                            time, or Outcome::none
///   witnessed()              there is one from the last run, and it is looked at first (else a
///                            query that wants a bound gets it from one way down from the roots)
///   opens(query, a, b, gap)  whether two nodes that the query culls are opened all the same
///   descent(a, b)            of two that are opened: whose children take their place
///   primitives(query, pending, workspace)
///                            asks the query about candidates, whose slots say where they come
///                            from, all of an entry's one after the other
///   measures_gaps            whether it wants to know `gap`s: for pairs that are culled, at most
///                            the distance between the volumes, in units of the meshes; else 0
///   held_at_least            candidates that are worth waiting for, as many as fill its batches
template <class F, class Traversal>
concept TrackedFront = requires(F front, Traversal& traversal, typename Traversal::Query& query,
                                const typename Traversal::Node& node, const NodePair& pair,
                                std::size_t slot, double gap, Seen seen,
                                std::span<const Candidate> pending, Workspace& workspace) {
  { front.sweep(traversal) } -> std::same_as<bool>;
  { front[slot] } -> std::convertible_to<NodePair>;
  front.stays(slot, seen, gap);
  front.open(slot);
  { front.add(pair, seen, gap) } -> std::same_as<std::size_t>;
  front.finish(slot, true);
  { front.witnessed() } -> std::same_as<bool>;
  { front.opens(query, node, node, gap) } -> std::same_as<bool>;
  { front.descent(node, node) } -> std::same_as<Descent>;
  { front.primitives(query, pending, workspace) } -> std::same_as<Outcome>;
  { F::measures_gaps } -> std::convertible_to<bool>;
  { F::held_at_least } -> std::convertible_to<std::size_t>;
};

struct FrontDefaults {
  static constexpr bool measures_gaps = false;
  static constexpr std::size_t held_at_least = 0;

  static void stays(std::size_t, Seen, double) {}
  static void finish(std::size_t, bool) {}
  static constexpr bool witnessed() { return false; }
  template <class Query, class Node>
  static constexpr bool opens(const Query&, const Node&, const Node&, double) {
    return false;
  }
  template <class Node>
  static constexpr Descent descent(const Node& a, const Node& b) {
    return into_larger(a, b);
  }
  template <class Query>
  [[gnu::always_inline]] static Outcome primitives(Query& query, std::span<const Candidate> pending,
                                                   Workspace&) {
    return query.primitives(pending);
  }
};

}  // namespace bvlab
