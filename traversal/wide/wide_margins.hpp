// SPDX-License-Identifier: BSD-3-Clause
/// What pairs of bodies over wide trees remember from frame to frame: how long nothing can have
/// changed, and where they touched.
///
/// A traversal that finds two bodies apart, and never had to look at triangles, has compared
/// volumes that are apart, and the least of their gaps is one of the bodies. Until these can have
/// come nearer by that much the answer stays, and costs one comparison: of a deadline with the
/// ways that the bodies have gone since the first frame (MovingBody::displacement_bound). Where
/// ways are long because bodies jitter or go together, the bound between reference poses is looked
/// at before the pair is. Bodies that touch are looked at where they did, first.
///
/// It does not pay to open volumes that are hardly apart so that the least gap grows: the triangles
/// of two surfaces are near each other in many places, and to know the nearest is to know the
/// distance, at five times the price.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "traversal/body_pair.hpp"
#include "traversal/relative_motion_bound.hpp"
#include "traversal/wide/wide_traversal.hpp"

namespace bvlab {

/// Nothing: every pair starts from the roots in every frame.
struct Forgetful {
  static constexpr std::string_view name = "recursive";
  static constexpr bool remembers = false;
  template <int F>
  using Measure = NotMeasuring;
};

/// Finds out how far apart two bodies are, at least, while it finds that they do not touch.
template <int F>
class MeasuringGap {
  using S = Batch<float, F>;

 public:
  static constexpr bool measures = true;

  void begin() { least_ = S(std::numeric_limits<float>::infinity()), touched_.reset(); }

  /// Which of the volumes so far apart are to be opened. Lanes without a child repeat one.
  [[gnu::always_inline]] std::uint64_t opened(const S& separation) {
    const auto apart = separation > S(0.0f);
    S gap(std::numeric_limits<float>::infinity());
    stdx::where(apart, gap) = separation;
    least_ = stdx::min(least_, gap);
    return ~bits(apart);
  }
  /// A triangle of a has been tested against a leaf of b; whether it may touch any.
  void triangles(const NodePair& at, bool touching) {
    least_ = S(0.0f);
    if (touching) touched_ = at;
  }

  /// A triangle of a, as leaves number them, and a leaf of b: where they touched, or may have.
  const std::optional<NodePair>& touched() const { return touched_; }
  /// What separations are short of distances by is in this (see slab_box_facing.hpp, gaps).
  double gap() const {
    const double least = stdx::hmin(least_);
    return least > 0 ? least * (1 - 32 * unit_roundoff<float>) : 0;
  }

 private:
  S least_;
  std::optional<NodePair> touched_;
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
    ways_.push_back(0), steps_.push_back(0), reaches_.push_back(0), epochs_.push_back(0);
  }
  void resize(std::size_t pairs) { answers_.resize(pairs), kept_.resize(pairs); }

  /// Another query than last time begins anew.
  template <class Query>
  void move(std::span<const Pose> poses) {
    if (asked_ != &Query::name) {
      std::fill(answers_.begin(), answers_.end(), Answer{});
      std::fill(kept_.begin(), kept_.end(), Kept{});
      asked_ = &Query::name;
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Followed& body = bodies_[i];
      steps_[i] = 0;
      if (!body.place(poses[i])) continue;
      const double way = body.displacement_bound();
      steps_[i] = way - ways_[i];
      ways_[i] = way, epochs_[i] = body.epoch();
      const ReferencePose& at = body.reference_pose();
      // A matrix stretches by its defect at most.
      reaches_[i] =
          (body.extent().radius * (1 + at.defect) + at.noise) * (1 + 16 * unit_roundoff<double>);
    }
  }

  /// Whether the answer is what it was, as far as one comparison tells.
  template <class Query>
  bool stays(std::size_t p, const ObjectPair& pair) const {
    const Answer& answer = answers_[p];
    return ways_[pair.i] + ways_[pair.j] < answer.until ||
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
  /// Whether the balls around them are apart.
  bool balls_apart(std::size_t p, const ObjectPair& pair) {
    const double reach = reaches_[pair.i] + reaches_[pair.j];
    const double distance =
        (bodies_[pair.i].reference_pose().centre - bodies_[pair.j].reference_pose().centre).norm() *
        (1 - 16 * unit_roundoff<double>);
    if (!(distance > reach)) return false;
    kept_[p].deadline = 0;
    answers_[p] = {0, epochs(pair), false};
    hold(p, pair, (distance - reach) * (1 - 4 * unit_roundoff<double>));
    return true;
  }

  /// Where they touched last time, if one hit is enough.
  template <class Query>
  std::optional<NodePair> touched(std::size_t p) const {
    if (!Query::one_hit_is_enough || !answers_[p].touching) return std::nullopt;
    return kept_[p].touched;
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
    if (answer.touching) {
      kept.touched = *found.touched();
      return;
    }
    // Less would hardly last until the next frame.
    const double gap = found.gap();
    if (!(gap > steps_[pair.i] + steps_[pair.j])) return;
    kept.clock.restart(bodies_[pair.i], bodies_[pair.j]);
    kept.deadline = kept.clock.deadline(gap);
    hold(p, pair, gap);
  }

 private:
  class Followed : public MovingBody {
   public:
    using MovingBody::MovingBody;
    bool place(const Pose& pose) { return MovingBody::place(pose, Vec3<double>::Zero()); }
  };

  struct Answer {
    double until = unknown;  ///< as a sum of ways; negative where only rest keeps it
    std::uint32_t epochs = 0;
    bool touching = false;
  };
  struct Kept {
    RelativeMotionBound clock;
    double deadline = 0;  ///< by the clock; 0: none
    double distance = 0;
    NodePair touched{};
  };

  static constexpr double unknown = -1;
  /// All that such a query says is kept: of contacts, only that there are none.
  template <class Query>
  static constexpr bool says_all = requires(Query query) {
    query.answer();
  };

  /// Changes whenever one of the bodies moves.
  std::uint32_t epochs(const ObjectPair& pair) const { return epochs_[pair.i] + epochs_[pair.j]; }

  /// The bodies are `gap` apart. Sums of ways are rounded here and where they are compared.
  void hold(std::size_t p, const ObjectPair& pair, double gap) {
    const double way = ways_[pair.i] + ways_[pair.j];
    answers_[p].until = (way + gap) * (1 - 8 * unit_roundoff<double>);
  }

  std::vector<Followed> bodies_;
  std::vector<double> ways_, steps_, reaches_;
  std::vector<std::uint32_t> epochs_;
  std::vector<Answer> answers_;
  std::vector<Kept> kept_;
  const std::string_view* asked_ = nullptr;
};

}  // namespace bvlab
