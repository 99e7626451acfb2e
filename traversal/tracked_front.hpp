// SPDX-License-Identifier: BSD-3-Clause
/// The concept of a front: the traversal starts from it and keeps it up to date.
///
/// The front is where the last recursion stopped in the bounding volume test tree (BVTT): the pairs
/// of nodes that were culled, and the pairs of leaves. A front decides what it keeps of a pair,
/// which entries a run tests, in which order, and which culled pairs it opens nevertheless.
///
/// Invariant: in every run the entries tested, with what is known of the others, decide the query;
/// and the entries partition the product of the two bodies' leaves, so that every pair of leaves
/// lies below exactly one. A front that keeps nothing (NoFront) starts from the roots.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>

#include "traversal/node_pair.hpp"
#include "traversal/queries/candidate.hpp"
#include "traversal/workspace.hpp"

namespace bvlab {

/// The work of one traversal.
struct TraversalStatistics {
  bool everything = true;     ///< false if the query ended the run early
  std::size_t volumes = 0;    ///< pairs of volumes tested
  std::size_t triangles = 0;  ///< pairs of primitives tested
  std::size_t posed = 0;      ///< volumes posed

  template <class Counter>
  void count(Counter& counter) const {
    counter.tested(volumes), counter.posed(posed), counter.primitives(triangles);
  }
};

/// What a run has found about an entry.
enum class EntryState {
  culled,  ///< the query culls it; its gap is known where gaps are measured
  near,    ///< not culled, both are leaves; primitives are tested unless a hit ends the run
  not_yet  ///< not tested, or not completely: the run ended before
};

/// The members. FrontDefaults has those that a simple front need not define. A slot is the number
/// under which the front knows an entry.
///   sweep(traversal)         tests entries by FrontSweep::test_entries (front_recorder.hpp), and
///                            returns whether the query is satisfied
///   front[slot]              the pair
///   keep(slot, state, gap)   a tested entry is kept; `state` is the result of its test
///   open(slot)               a tested entry is replaced: the next pair that is added, of at least
///                            two, takes its slot
///   add(pair, state, gap)    adds the pair as an entry; returns its slot
///   finish(witness, satisfied)
///                            the run is over, ended by the query or not; `witness` is the slot
///                            of the entry to test first in the next run, or Outcome::none
///   witnessed()              whether there is a witness, which is tested first (else a query that
///                            wants a bound gets it from one descent from the roots)
///   opens(query, a, b, gap)  whether two nodes are opened although the query culls them
///   descent(a, b)            which node of an opened pair is replaced, or both
///   primitives(query, pending, workspace)
///                            passes candidates to the query; their slots name their entries, and
///                            those of one entry are consecutive
///   measures_gaps            whether the front uses `gap`: a lower bound on the distance of the
///                            volumes of culled pairs, in units of the meshes; else 0
///   held_at_least            candidates are tested together once more than this many are held
template <class F, class Traversal>
concept TrackedFront = requires(F front, Traversal& traversal, typename Traversal::Query& query,
                                const typename Traversal::Node& node, const NodePair& pair,
                                std::size_t slot, double gap, EntryState state,
                                std::span<const Candidate> pending, Workspace& workspace) {
  { front.sweep(traversal) } -> std::same_as<bool>;
  { front[slot] } -> std::convertible_to<NodePair>;
  front.keep(slot, state, gap);
  front.open(slot);
  { front.add(pair, state, gap) } -> std::same_as<std::size_t>;
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

  static void keep(std::size_t, EntryState, double) {}
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
