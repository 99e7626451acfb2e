// SPDX-License-Identifier: BSD-3-Clause
/// No front is kept: each pair of bodies starts from the roots in every frame. Kept are the last
/// answer, which decides the order of steps, and, if asked for, the two leaves that decided the
/// last run (a witness), which are tested first.
///
/// A memory keeps state of pairs of bodies from frame to frame. WidePairs calls
///   add_body(extent), resize(pairs)         for the bodies and the number of pairs
///   forget(pair)                            when a pair parts
///   begin_frame<Query>()                    begins a frame; forgets all if the query differs
///   move(i, body, pose, culling, origin)    body i is at `pose`
///   rest(i)                                 body i does not move
///   front_size(pair), front_size()          entries of the front of one pair, of all
///   require(body, pose)                     sets the pose of a body before it is traversed
///   answer_valid<Query>(pair, bodies)       whether the last answer holds, by one comparison
///   repeat(pair, query)                     gives a query the last answer
///   cull<Query>(sieve, scene, counter, make_query)  decides pairs by what it has kept
///   skips_directions(pair)                  see EarlyCulling::cull_by_directions
///   apart(pair, bodies, gap)                a direction has separated the pair
///   start<Query>(pair, bodies)              where a traversal starts
///   remember(pair, bodies, query, record)   keeps what the traversal has found
/// and uses Record<S>, the type of what a traversal records for it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hierarchies/hierarchy_extent.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/wide/early_culling.hpp"
#include "traversal/wide/front_record.hpp"

namespace bvlab {

/// What a memory may use to decide pairs early.
struct PairScene {
  std::span<const ObjectPair> pairs;
  std::span<const Pose> poses;                  ///< of all bodies
  std::span<const TriangleMesh* const> meshes;  ///< of all bodies
  const EarlyCulling& culling;
};

class NoMemory {
 public:
  static constexpr std::string_view name = "recursive";
  template <class S>
  using Record = FrontRecord<S, Keeps::nothing>;

  enum class Witness : std::uint8_t { none, kept };
  NoMemory() = default;
  explicit NoMemory(Witness witness) : witness_(witness) {}

  void add_body(const HierarchyExtent& extent) { spheres_.push_back(extent); }
  void resize(std::size_t pairs) {
    touched_.resize(pairs);
    if (witness_ == Witness::kept) witnesses_.resize(pairs);
  }
  void forget(std::size_t p) {
    if (witness_ == Witness::kept) witnesses_[p].reset();
  }
  /// Another query than in the last frame starts without a witness; returns whether it is another.
  template <class Query>
  bool begin_frame() {
    if (last_query_ == &Query::name) return false;
    last_query_ = &Query::name;
    std::fill(witnesses_.begin(), witnesses_.end(), std::nullopt);
    return true;
  }

  template <class Body>
  void move(std::size_t i, Body& body, const Pose& pose, EarlyCulling& culling,
            const Vec3<double>& origin) const {
    body.set_pose(pose);
    culling.set_pose(i, pose.rotation,
                     position_about(origin, pose, body.hierarchy().origin(), spheres_[i].centre),
                     spheres_[i].radius, body.orthonormal_pose().error_bound);
  }
  static void rest(std::size_t) {}
  static constexpr std::size_t front_size(std::size_t = 0) { return 0; }
  template <class Body>
  static void require(Body&, const Pose&) {}

  template <class Query>
  static constexpr bool answer_valid(std::size_t, const ObjectPair&) {
    return false;
  }
  template <class Query>
  static void repeat(std::size_t, Query&) {}
  template <class Query, class Counter, class MakeQuery>
  static void cull(PairSieve& sieve, const PairScene& scene, Counter&, MakeQuery&&) {
    scene.culling.cull_by_spheres(sieve, scene.pairs);
  }
  static constexpr bool skips_directions(std::size_t) { return false; }
  static void apart(std::size_t, const ObjectPair&, double) {}

  template <class Query>
  TraversalStart start(std::size_t p, const ObjectPair&) const {
    TraversalStart start;
    // The last answer is the one to expect next.
    if constexpr (AnswersYesOrNo<Query>)
      start.expect = touched_[p] ? Expect::touching : Expect::apart;
    if constexpr (!FindsAllHits<Query>)
      if (witness_ == Witness::kept) start.witness = witnesses_[p];
    return start;
  }
  template <class Query, class Record>
  void remember(std::size_t p, const ObjectPair&, const Query& query, const Record& found) {
    if constexpr (AnswersYesOrNo<Query>) touched_[p] = query.answer();
    if (witness_ == Witness::kept && found.touched()) witnesses_[p] = found.touched();
  }

 private:
  std::vector<HierarchyExtent> spheres_;  // of the bodies
  std::vector<std::uint8_t> touched_;  // in the last frame; affects only the order of steps
  Witness witness_ = Witness::none;
  std::vector<std::optional<NodePair>> witnesses_;
  const std::string_view* last_query_ = nullptr;
};

}  // namespace bvlab
