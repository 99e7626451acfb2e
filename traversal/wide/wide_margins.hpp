// SPDX-License-Identifier: BSD-3-Clause
/// A memory that keeps the last answer of each pair of bodies for as long as it is valid.
///
/// A gap between two bodies is found by a direction that separates them, or by a traversal: the
/// least gap of the volumes that it found apart bounds the distance unless triangles were tested.
/// The answer is valid until the bodies can have closed that gap (lasting_answer.hpp).
///
/// Bodies that touch keep touching until an edge that crosses a triangle can have left it. Then
/// these two triangles are tested (triangle_margin.hpp), in a batch with those of other pairs.
/// Triangles that meet without a margin, as coplanar faces do, are tested in every frame by the
/// query's own test. If they no longer meet, or no longer with a margin, the bodies are traversed,
/// first where they touched.
///
/// A pair that was traversed before, and found apart where one hit is enough, writes a front
/// (WideFront) in its next traversal. Later traversals retest only the entries whose gaps may have
/// come down to the query's limit. Where that costs over three quarters of a traversal from the
/// roots, the pair keeps no front for sixteen traversals, and for four times as many each time this
/// recurs, at most 256. A distance also keeps the nearest two triangles, which are tested first.
/// Where all contacts are sought, the verdicts on near triangles become entries, if they last.
///
/// Tried and not kept: to measure no gaps where few traversals were spared lately, as in fast
/// motion. It gains a tenth there, but single pairs take up to half as long again: they are spared
/// in some phases of a motion and not in others. A mean over more traversals gains nothing.
///
/// Also tried: to open volumes with a small gap, so that the least gap grows. It costs five times
/// as much, and the least gap stays that of the nearest triangles.
///
/// Also tried: to measure gaps of triangles in other traversals than retests. A third
/// of the tests remains, and each gap costs as much as four tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>
#include <vector>

#include "traversal/queries/query.hpp"
#include "traversal/wide/crossing_batch.hpp"
#include "traversal/wide/followed_bodies.hpp"
#include "traversal/wide/front_record.hpp"
#include "traversal/wide/kept_of_pair.hpp"
#include "traversal/wide/no_memory.hpp"

namespace bvlab {

/// For every pair of bodies: its last answer, how long it is valid, and where they touched.
class WideMargins {
 public:
  static constexpr std::string_view name = "margins";
  template <class S>
  using Record = FrontRecord<S, Keeps::gaps>;

  void add_body(const HierarchyExtent& extent) {
    bodies_.add(extent);
  }
  void resize(std::size_t pairs) {
    answers_.resize(pairs), kept_.resize(pairs), front_sizes_.resize(pairs);
  }

  /// Forgets pair p, which has parted.
  void forget(std::size_t p) {
    answers_[p] = {};
    Kept& kept = kept_[p];
    kept.lasting.forget(), kept.known = kept.was_apart = kept.touched_twice = false;
    kept.crossing.reset(), kept.crossing_pause = 0, kept.next_crossing_pause = 1;
    clear_front(p), kept.pause = kept.verdicts_pause = {};
  }

  /// The entries of the front of pair p, and of all pairs.
  std::size_t front_size(std::size_t p) const { return front_sizes_[p]; }
  std::size_t front_size() const {
    return std::accumulate(front_sizes_.begin(), front_sizes_.end(), std::size_t{0});
  }

  /// Another query than in the last frame starts without memory. The parameters of a query, as the
  /// relative error of distances, must not change between frames.
  template <class Query>
  void begin_frame() {
    if (last_query_ == &Query::name) return;
    std::fill(answers_.begin(), answers_.end(), Answer{});
    std::fill(kept_.begin(), kept_.end(), Kept{});
    std::fill(front_sizes_.begin(), front_sizes_.end(), 0);
    last_query_ = &Query::name;
  }
  /// Body i is at `pose` in this frame. The pose of `Body` itself is set when a traversal needs it.
  template <class Body>
  void move(std::size_t i, Body&, const Pose& pose, EarlyCulling& culling,
            const Vec3<double>& origin) {
    if (!bodies_.set_pose(i, pose)) return;
    const ReferencePose& at = bodies_[i].present_pose();
    culling.set_pose(i, at.rotation, at.centre - origin, bodies_[i].extent().radius,
                     at.defect < 0.1 ? at.error_bound : std::numeric_limits<double>::infinity());
  }
  template <class Body>
  static void require(Body& body, const Pose& pose) {
    body.set_pose(pose);
  }
  /// Body i has not moved since the last frame.
  void rest(std::size_t i) { bodies_.rest(i); }

  /// Whether the last answer still holds, by one comparison.
  template <class Query>
  bool answer_valid(std::size_t p, const ObjectPair& pair) const {
    const Answer& answer = answers_[p];
    return bodies_.displacement(pair) < answer.until ||
           (keeps_answer<Query> && bodies_.epochs(pair) == answer.epochs);
  }
  /// Decides the pairs whose answers are valid by the bound from reference poses and, where one
  /// hit is enough, those whose last crossing still exists.
  template <class Query, class Counter, class MakeQuery>
  void cull(PairSieve& sieve, const PairScene& scene, Counter& counter, MakeQuery&& make_query) {
    sieve.sift([&](std::size_t p) { return answer_valid_by_reference_pose(p, scene.pairs[p]); });
    if constexpr (Query::one_hit_is_enough) cull_by_crossings(sieve, scene, counter, make_query);
  }
  /// Pairs with a front, or that touch and were not apart before, are not tested by directions.
  bool skips_directions(std::size_t p) const {
    return kept_[p].front.is_complete() || kept_[p].touched_twice;
  }
  /// The bodies are `gap` apart at their present poses.
  void apart(std::size_t p, const ObjectPair& pair, double gap) {
    Kept& kept = kept_[p];
    answers_[p] = {unknown, bodies_.epochs(pair), false};
    kept.crossing.reset(), clear_front(p);
    kept.known = kept.was_apart = true, kept.touched_twice = false;
    extend_validity(p, pair, gap);
  }

  template <class Query>
  TraversalStart start(std::size_t p, const ObjectPair& pair) {
    Kept& kept = kept_[p];
    TraversalStart start;
    start.expect = answers_[p].touching ? Expect::touching : Expect::apart;
    if (wants_bound<Query>())
      start.witness = kept.touched;
    else if (DecidedByOneHit<Query> && answers_[p].touching)
      start.touched = kept.touched;
    // A front pays from the second traversal on, unless the last ones wore out at once; where one
    // hit is enough, while the bodies are apart.
    const bool is_useful = wants_bound<Query>()     ? kept.touched.has_value()
                           : DecidedByOneHit<Query> ? kept.was_apart
                                                    : true;
    if (kept.pause.over() && kept.known && is_useful) start.front = &kept.front;
    if constexpr (FindsAllHits<Query>)
      start.verdicts = kept.front.is_complete() && kept.verdicts_pause.over();
    start.rotation = bodies_.rotation(pair);
    start.step = static_cast<float>(bodies_.step(pair));
    return start;
  }

  /// Gives a query the last answer.
  template <class Query>
  void repeat(std::size_t p, Query& query) const {
    if constexpr (requires { query.nearest(); }) {
      query.repeat(kept_[p].nearest);
    } else if constexpr (FindsAllHits<Query>) {
      for (const WideFront::Hit& hit : kept_[p].front.hits)
        query.known(hit.triangles.a, hit.triangles.b);
    } else if (answers_[p].touching) {
      query.known(kept_[p].touched->a, kept_[p].touched->b);
    }
  }

  template <class Query, class Record>
  void remember(std::size_t p, const ObjectPair& pair, const Query& query, const Record& found) {
    Answer& answer = answers_[p];
    Kept& kept = kept_[p];
    answer = {unknown, bodies_.epochs(pair), found.touched().has_value()};
    if constexpr (AnswersYesOrNo<Query>) answer.touching = query.answer();
    if constexpr (FindsAllHits<Query>)
      answer.touching = answer.touching || !kept.front.hits.empty();
    kept.lasting.forget();
    kept.crossing.reset();
    kept.known = true;
    if (found.touched()) kept.touched = found.touched();
    keep_front(p, found);
    if constexpr (wants_bound<Query>()) {
      kept.nearest = query.nearest();  // it holds while neither body moves
      return;
    } else {
      kept.touched_twice = answer.touching && !kept.was_apart;
      kept.was_apart = !answer.touching;
      if (DecidedByOneHit<Query> && answer.touching) {
        if (kept.crossing_pause > 0)
          --kept.crossing_pause;
        else
          kept.crossing = found.crossing();
        return clear_front(p);
      }
      // A smaller gap would hardly last until the next frame; and the front has the hits.
      const double gap = answer.touching && !kept.front.is_complete() ? 0 : found.gap();
      if (gap > bodies_.step(pair)) extend_validity(p, pair, gap);
    }
  }

 private:
  static constexpr int longest_crossing_pause = 64;  // traversals without a crossing

  using Answer = PairAnswer;
  using Kept = KeptOfPair;
  static constexpr double unknown = PairAnswer::unknown;
  /// Queries whose whole answer is kept; of contacts, it is only kept that there are none.
  template <class Query>
  static constexpr bool keeps_answer = requires(Query query) { query.answer(); };

  bool answer_valid_by_reference_pose(std::size_t p, const ObjectPair& pair) {
    const double remaining = kept_[p].lasting.remaining(bodies_[pair.i], bodies_[pair.j]);
    if (!(remaining > 0)) return false;
    answers_[p].until = displacement_at_expiry(bodies_.displacement(pair), remaining);
    return true;
  }

  template <class Counter, class MakeQuery>
  void cull_by_crossings(PairSieve& sieve, const PairScene& scene, Counter& counter,
                         MakeQuery& make_query) {
    CrossingBatch batch;
    const auto decide = [&](std::size_t p, bool crossing, double margin) {
      if (crossing)
        still_crossing(p, scene.pairs[p], margin);
      else
        lost_crossing(p);
      sieve.put(static_cast<std::int32_t>(p), !crossing);
    };
    const auto test = [&] {
      batch.test(counter, [&](std::size_t p, double margin) { decide(p, margin > 0, margin); });
    };
    sieve.sift_deferred([&](std::size_t p) {
      const auto& crossing = kept_[p].crossing;
      if (!crossing) return sieve.put(static_cast<std::int32_t>(p), true);
      const auto triangle = [&](std::uint32_t body, std::uint32_t index) {
        return scene.poses[body](scene.meshes[body]->corners(index));
      };
      const Triangle a = triangle(scene.pairs[p].i, crossing->a),
                     b = triangle(scene.pairs[p].j, crossing->b);
      if (crossing->certain) {
        batch.add(p, a, b);
        if (batch.full()) test();
      } else {
        const Candidate candidate{&a, &b, crossing->a, crossing->b, 0};
        counter.primitives(1);
        auto query = make_query(static_cast<std::uint32_t>(p), scene.pairs[p]);
        decide(p, query.primitives(std::span(&candidate, 1)).satisfied, 0);
      }
    });
    test();
  }
  /// The triangles still cross, and will until the bodies have moved by `margin`.
  void still_crossing(std::size_t p, const ObjectPair& pair, double margin) {
    answers_[p] = {unknown, bodies_.epochs(pair), true};
    kept_[p].lasting.forget(), kept_[p].touched_twice = true;
    kept_[p].next_crossing_pause = std::max(1, kept_[p].next_crossing_pause / 2);
    if (margin > bodies_.step(pair)) extend_validity(p, pair, margin);
  }
  /// It is no longer certain that the triangles cross. In such motion, testing the next crossing
  /// first does not pay.
  void lost_crossing(std::size_t p) {
    Kept& kept = kept_[p];
    kept.crossing_pause = kept.next_crossing_pause;
    kept.next_crossing_pause = std::min(4 * kept.next_crossing_pause, longest_crossing_pause);
  }

  template <class Record>
  void keep_front(std::size_t p, const Record& found) {
    Kept& kept = kept_[p];
    if (found.sweeps() || found.worn()) kept.pause.begin(found.worn());
    if (found.keeps_front() && !found.sweeps()) kept.front.complete();
    if (found.has_verdicts()) kept.verdicts_pause.begin(found.verdicts_worn());
    if (kept.front.overgrown() || found.verdicts_worn()) kept.front.clear();
    front_sizes_[p] = static_cast<std::uint32_t>(kept.front.size());
  }
  void clear_front(std::size_t p) { kept_[p].front.clear(), front_sizes_[p] = 0; }

  /// Makes the answer valid until the bodies have come nearer by `gap`.
  void extend_validity(std::size_t p, const ObjectPair& pair, double gap) {
    kept_[p].lasting.restart(bodies_[pair.i], bodies_[pair.j], gap);
    answers_[p].until = displacement_at_expiry(bodies_.displacement(pair), gap);
  }

  FollowedBodies bodies_;
  std::vector<Answer> answers_;
  std::vector<Kept> kept_;
  std::vector<std::uint32_t> front_sizes_;  // of kept_, apart from it, to be summed quickly
  const std::string_view* last_query_ = nullptr;
};

}  // namespace bvlab
