// SPDX-License-Identifier: BSD-3-Clause
/// Nothing is kept of a traversal: each pair of bodies starts from the roots in every frame. Only
/// the last answer is kept, which decides the order of steps.
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

#include <cstdint>
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

  void add_body(const HierarchyExtent& extent) { spheres_.push_back(extent); }
  void resize(std::size_t pairs) { touched_.resize(pairs); }
  static void forget(std::size_t) {}
  template <class Query>
  static void begin_frame() {}

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
    // The last answer is the one to expect next.
    if constexpr (AnswersYesOrNo<Query>)
      return {touched_[p] ? Expect::touching : Expect::apart};
    else
      return {};
  }
  template <class Query, class Record>
  void remember(std::size_t p, const ObjectPair&, const Query& query, const Record&) {
    if constexpr (AnswersYesOrNo<Query>) touched_[p] = query.answer();
  }

 private:
  std::vector<HierarchyExtent> spheres_;  // of the bodies
  std::vector<std::uint8_t> touched_;  // in the last frame; affects only the order of steps
};

}  // namespace bvlab
