// SPDX-License-Identifier: BSD-3-Clause
/// What pairs of bodies over wide trees remember from frame to frame: how long nothing can have
/// changed, and where they touched.
///
/// How far apart two bodies are is told by a direction in which they do not reach each other, or by
/// a traversal: the least gap of volumes that it found apart is one of the bodies unless triangles
/// had to be looked at. Until the bodies can have come nearer by that much the answer stays, and
/// costs one comparison: of a deadline with the displacements since the first frame
/// (MovingBody::displacement_bound). Where displacements are long because bodies jitter or go
/// together, the bound between reference poses is looked at before the pair is.
///
/// Bodies that touch go on to touch until one edge that crosses a triangle can have left it; after
/// that these two are looked at (triangle_margin.hpp), of several pairs of bodies at once, and only
/// then the bodies, first where they touched.
///
/// Bodies that were apart twice, but hardly, get a front (WideFront), of which only that is looked
/// at again which can have come together. Where that is most of it, there is none for a while:
/// sixteen traversals, four times as many whenever that comes again, 256 at most.
///
/// Tried and not kept: to open volumes that are hardly apart so that the least gap grows. Triangles
/// of two surfaces are near each other in many places, and to know the nearest is to know the
/// distance, at five times the price. Nor does it pay to measure triangles that are apart by more
/// than the volumes they have anyway, exactly or not: a third of the tests is left, each gap costs
/// four, and of 8000 polygons many are within a step or two of each other.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "traversal/body_pair.hpp"
#include "traversal/relative_motion_bound.hpp"
#include "traversal/wide/separating_direction.hpp"
#include "traversal/wide/wide_front.hpp"
#include "traversal/wide/wide_traversal.hpp"

namespace bvlab {

/// Nothing: every pair starts from the roots in every frame.
struct Forgetful {
  static constexpr std::string_view name = "recursive";
  static constexpr bool remembers = false;
  template <int F>
  using Measure = NotMeasuring;
};

/// Triangles that cross for certain, by their numbers in their meshes.
struct Crossing {
  std::uint32_t a, b;
};

/// Finds out how far apart two bodies are, at least, while it finds that they do not touch.
template <int F>
class MeasuringGap {
  using S = Batch<float, F>;

 public:
  static constexpr bool measures = true;

  /// A front that is not complete is written anew. Both bodies have turned by `turn` since the
  /// first frame.
  void begin(WideFront* front, double turn) {
    front_ = front, turn_ = turn;
    sweeps_ = front && front->is_complete(), swept_ = false, due_ = 0;
    if (front && !sweeps_) front->clear();
    least_ = S(infinity), least_left_ = WideFront::S(infinity);
    touched_.reset(), crossing_.reset();
  }

  /// Whether it starts from a front, and whether that has been looked at.
  bool sweeps() const { return sweeps_; }
  bool swept() const { return swept_; }
  WideFront& sweep() { return swept_ = true, *front_; }
  bool front() const { return front_; }
  std::size_t due() const { return due_; }

  /// Which of the entries `first` and up, so many, can have come together.
  [[gnu::always_inline]] std::uint64_t due(std::size_t first, std::size_t entries,
                                           const CornersBetween& corners) {
    const WideFront::S left = front_->left(first, corners, turn_);
    const std::size_t lanes = std::min<std::size_t>(entries, WideFront::width);
    const auto apart = left > WideFront::S(0.0f);
    stdx::where(apart, least_left_) = stdx::min(least_left_, left);
    const std::uint64_t due = ~bits(apart) & ((std::uint64_t{1} << lanes) - 1);
    due_ += static_cast<std::size_t>(std::popcount(due));
    return due;
  }

  /// Which of the volumes so far apart are to be opened. Lanes without a child repeat one.
  [[gnu::always_inline]] std::uint64_t opened(const S& separation) {
    const auto apart = separation > S(0.0f);
    last_ = S(infinity);
    stdx::where(apart, last_) = separation;
    least_ = stdx::min(least_, last_);
    return ~bits(apart);
  }
  /// The same of a pair of nodes: those which have not been opened before. The one of `side` has
  /// been tested against the lanes.
  template <class Between>
  [[gnu::always_inline]] std::uint64_t left(const NodePair& pair, std::uint64_t lanes,
                                            std::size_t entry, const Between& between,
                                            std::size_t side, std::uint32_t node) {
    if (!front_) return lanes;
    std::uint64_t fresh = lanes;
    if (entry == WideFront::none) {
      entry = front_->add({pair, static_cast<std::uint16_t>(lanes), 0, 0});
    } else {
      auto& opened = (*front_)[entry].opened;
      fresh = lanes & ~std::uint64_t{opened};
      opened = static_cast<std::uint16_t>(opened | fresh);
    }
    front_->is_apart(entry, stdx::hmin(last_), between.place(side, node), turn_);
    return fresh;
  }
  /// A triangle of a has been tested against a leaf of b; whether it may touch any. Says whether
  /// their gap is to be measured.
  bool triangles(const NodePair& pair, bool touching, std::size_t entry) {
    if (touching) touched_ = pair;
    if (!front_ || entry == WideFront::none) {
      least_ = S(0.0f);
      if (front_) front_->add({pair, 0, 1, 0});
      return false;
    }
    auto& rest = (*front_)[entry].rest;
    if (rest > 0) --rest;
    if (!touching && rest == 0) return true;
    least_ = S(0.0f);
    return false;
  }
  void crossing(std::uint32_t a, std::uint32_t b) { crossing_ = {a, b}; }
  const std::optional<Crossing>& crossing() const { return crossing_; }
  void triangles_are(const S& gaps, std::size_t entry, const Place& place) {
    const S known = select(gaps > S(0.0f), gaps, S(0.0f));
    least_ = stdx::min(least_, known);
    const float gap = stdx::hmin(known);
    front_->is_apart(entry, gap, place, turn_);
    if (!(gap > 0)) (*front_)[entry].rest = 8;
  }

  /// A triangle of a, as leaves number them, and a leaf of b: where they touched, or may have.
  const std::optional<NodePair>& touched() const { return touched_; }
  /// What separations are short of distances by is in this (see slab_box_facing.hpp, gaps).
  double gap() const {
    const double least = std::min(stdx::hmin(least_), stdx::hmin(least_left_));
    return least > 0 ? least * (1 - 32 * unit_roundoff<float>) : 0;
  }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();

  S least_, last_;
  WideFront::S least_left_;
  std::optional<NodePair> touched_;
  std::optional<Crossing> crossing_;
  WideFront* front_ = nullptr;
  double turn_ = 0;
  std::size_t due_ = 0;
  bool sweeps_ = false, swept_ = false;
};

/// For every pair of bodies its last answer, until when it stays, and where they touched.
class WideMargins {
 public:
  static constexpr std::string_view name = "margins";
  static constexpr bool remembers = true;
  template <int F>
  using Measure = MeasuringGap<F>;

  void add_body(const MeshBall& ball, double reach) {
    bodies_.emplace_back(HierarchyExtent{ball.centre, ball.radius, reach, 0});
    displacements_.push_back(0), steps_.push_back(0), turns_.push_back(0), epochs_.push_back(0);
  }
  void resize(std::size_t pairs) { answers_.resize(pairs), kept_.resize(pairs); }

  /// A pair that parts.
  void forget(std::size_t p) {
    answers_[p] = {};
    Kept& kept = kept_[p];
    kept.deadline = 0, kept.was_apart = kept.touched_again = false;
    kept.crossing.reset(), kept.rest = 0, kept.next_rest = 1, kept.pause = 0,
                           kept.next_pause = shortest_pause;
    kept.front.clear();
  }

  /// Another query than last time begins anew.
  template <class Query>
  void begin_frame() {
    if (asked_ == &Query::name) return;
    std::fill(answers_.begin(), answers_.end(), Answer{});
    std::fill(kept_.begin(), kept_.end(), Kept{});
    asked_ = &Query::name;
  }
  /// Where a body stands in this frame; says whether it has moved.
  bool move(std::size_t i, const Pose& pose) {
    Followed& body = bodies_[i];
    steps_[i] = 0;
    if (!body.place(pose)) return false;
    const double displacement = body.displacement_bound();
    steps_[i] = displacement - displacements_[i];
    displacements_[i] = displacement, turns_[i] = body.turn_bound();
    epochs_[i] = body.epoch();
    return true;
  }
  /// Where it stood in the last.
  void rest(std::size_t i) { steps_[i] = 0; }

  /// Whether the answer is what it was, as far as one comparison tells.
  template <class Query>
  bool stays(std::size_t p, const ObjectPair& pair) const {
    const Answer& answer = answers_[p];
    return displacements_[pair.i] + displacements_[pair.j] < answer.until ||
           (says_all<Query> && epochs(pair) == answer.epochs);
  }
  /// Whether that is so by the bound between reference poses.
  bool stays_after_all(std::size_t p, const ObjectPair& pair) {
    Kept& kept = kept_[p];
    if (!(kept.deadline > 0)) return false;
    kept.clock.advance(bodies_[pair.i], bodies_[pair.j]);
    const double left = kept.deadline - kept.clock.now();
    if (!(left > 0)) return false;
    hold(p, pair, left * (1 - 4 * unit_roundoff<double>));
    return true;
  }
  /// The bodies are so far apart, from where they stand now.
  void apart(std::size_t p, const ObjectPair& pair, double gap) {
    Kept& kept = kept_[p];
    answers_[p] = {unknown, epochs(pair), false};
    kept.crossing.reset(), kept.front.clear();
    kept.was_apart = true, kept.touched_again = false;
    stays_for(p, pair, gap);
  }

  /// What crossed when the pair was looked at last: all that is asked of it, if one hit is enough,
  /// while those triangles still do.
  const std::optional<Crossing>& crossing(std::size_t p) const { return kept_[p].crossing; }
  /// They do, until the bodies have come so far.
  void goes_on_crossing(std::size_t p, const ObjectPair& pair, double margin) {
    answers_[p] = {unknown, epochs(pair), true};
    kept_[p].deadline = 0, kept_[p].touched_again = true;
    kept_[p].next_rest = std::max(1, kept_[p].next_rest / 2);
    if (margin > steps_[pair.i] + steps_[pair.j]) stays_for(p, pair, margin);
  }
  /// They do no longer, or hardly: motions are so large that what crosses next is not worth asking.
  void stops_crossing(std::size_t p) {
    Kept& kept = kept_[p];
    kept.rest = kept.next_rest;
    kept.next_rest = std::min(4 * kept.next_rest, longest_rest);
  }
  /// Whether they touched the last two times that they were looked at.
  bool goes_on(std::size_t p) const { return kept_[p].touched_again; }

  /// Where they touched last time, if one hit is enough.
  template <class Query>
  std::optional<NodePair> touched(std::size_t p) const {
    if (!Query::one_hit_is_enough || !answers_[p].touching) return std::nullopt;
    return kept_[p].touched;
  }

  /// Where it is worth keeping one: it has been apart before, and fronts did not wear out at once.
  WideFront* front(std::size_t p) {
    Kept& kept = kept_[p];
    if (kept.pause > 0) return --kept.pause, nullptr;
    return kept.was_apart ? &kept.front : nullptr;
  }
  /// Whether it is known which lanes are apart by how much.
  bool has_front(std::size_t p) const { return kept_[p].front.is_complete(); }
  /// What both have turned by since the first frame, at most.
  double turn(const ObjectPair& pair) const { return turns_[pair.i] + turns_[pair.j]; }
  /// Puts a body where it stands among those whose directions are looked along.
  void stand(std::size_t i, SeparatingDirections& directions, std::int32_t map,
             const Vec3<double>& origin) {
    const ReferencePose& at = bodies_[i].reference_pose();
    const double noise = at.defect < 0.1 ? at.noise : std::numeric_limits<double>::infinity();
    directions.stand(i, map, at.rotation, at.centre - origin, bodies_[i].extent().radius, noise);
  }

  /// Gives a query that was not asked the answer of the last one.
  template <class Query>
  void repeat(std::size_t p, Query& query) const {
    if constexpr (requires { query.stays(0.0); })
      query.stays(kept_[p].distance);
    else if (answers_[p].touching)
      query.known(kept_[p].touched.a, kept_[p].touched.b);
  }

  /// A distance stays while neither body moves.
  template <class Query>
  void remember(std::size_t p, const ObjectPair& pair, const Query& query, const NotMeasuring&) {
    answers_[p] = {unknown, epochs(pair), false};
    kept_[p].distance = query.distance();
  }
  template <class Query, int F>
  void remember(std::size_t p, const ObjectPair& pair, const Query& query,
                const MeasuringGap<F>& found) {
    Answer& answer = answers_[p];
    Kept& kept = kept_[p];
    answer = {unknown, epochs(pair), found.touched().has_value()};
    if constexpr (says_all<Query>) answer.touching = query.touching();
    kept.deadline = 0;
    kept.crossing.reset();
    kept.touched_again = answer.touching && !kept.was_apart;
    kept.was_apart = !answer.touching;
    if (answer.touching) {
      kept.touched = *found.touched();
      if (kept.rest > 0)
        --kept.rest;
      else
        kept.crossing = found.crossing();
      kept.front.clear();
      return;
    }
    if (found.front()) {
      WideFront& front = kept.front;
      // What is looked at again costs as much as in a traversal, and the rest is to pay for making
      // fronts.
      const bool worn = found.sweeps() && 4 * found.due() > 3 * front.size();
      if (!found.sweeps()) {
        front.complete();
      } else if (worn) {
        kept.pause = kept.next_pause;
        kept.next_pause = std::min(4 * kept.next_pause, longest_pause);
      } else {
        kept.next_pause = shortest_pause;
      }
      if (worn || front.overgrown()) front.clear();
    }
    // Less would hardly last until the next frame.
    const double gap = found.gap();
    if (gap > steps_[pair.i] + steps_[pair.j]) stays_for(p, pair, gap);
  }

 private:
  class Followed : public MovingBody {
   public:
    using MovingBody::MovingBody;
    bool place(const Pose& pose) { return MovingBody::place(pose, Vec3<double>::Zero()); }
  };

  static constexpr int shortest_pause = 16, longest_pause = 256;  // traversals without a front
  static constexpr int longest_rest = 64;                         // traversals without a crossing

  struct Answer {
    double until = unknown;  ///< as a sum of displacements; negative where only rest keeps it
    std::uint32_t epochs = 0;
    bool touching = false;
  };
  struct Kept {
    RelativeMotionBound clock;
    double deadline = 0;  ///< by the clock; 0: none
    double distance = 0;
    NodePair touched{};
    WideFront front;
    int pause = 0, next_pause = shortest_pause;
    std::optional<Crossing> crossing;
    int rest = 0, next_rest = 1;  // how many times what crosses is not to be kept
    bool was_apart = false, touched_again = false;
  };

  static constexpr double unknown = -1;
  /// All that such a query says is kept: of contacts, only that there are none.
  template <class Query>
  static constexpr bool says_all = requires(Query query) {
    query.answer();
  };

  /// Changes whenever one of the bodies moves.
  std::uint32_t epochs(const ObjectPair& pair) const { return epochs_[pair.i] + epochs_[pair.j]; }

  /// The answer stays until the bodies have come so much nearer.
  void stays_for(std::size_t p, const ObjectPair& pair, double gap) {
    Kept& kept = kept_[p];
    kept.clock.restart(bodies_[pair.i], bodies_[pair.j]);
    kept.deadline = kept.clock.deadline(gap);
    hold(p, pair, gap);
  }

  /// The bodies are `gap` apart. Sums of displacements are rounded here and where they are
  /// compared.
  void hold(std::size_t p, const ObjectPair& pair, double gap) {
    const double displacement = displacements_[pair.i] + displacements_[pair.j];
    answers_[p].until = (displacement + gap) * (1 - 8 * unit_roundoff<double>);
  }

  std::vector<Followed> bodies_;
  std::vector<double> displacements_, steps_, turns_;
  std::vector<std::uint32_t> epochs_;
  std::vector<Answer> answers_;
  std::vector<Kept> kept_;
  const std::string_view* asked_ = nullptr;
};

}  // namespace bvlab
