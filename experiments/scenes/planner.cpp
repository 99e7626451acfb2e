// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/planner.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "experiments/scenes/circle.hpp"
#include "experiments/scenes/places.hpp"

namespace bvlab {
namespace {

class Search {
 public:
  Search(const Planner& options, std::span<const Extent> meshes, const TouchesAny& touches)
      : options_(options),
        meshes_(meshes),
        touches_(touches),
        half_side_(resolved(options.side, meshes, "side") / 2),
        step_(resolved(options.step, meshes, "step")),
        robot_(options.objects - 1),
        random_(options.seed) {
    need(step_ > 0 && std::isfinite(half_side_ + step_), "side, step: too small or too large");
    // The largest chord, between unit quaternions, of a turn by `degrees`.
    const auto [cosine, sine] = cosine_sine(options.degrees / 1440);
    chord_ = 2 * sine;
  }

  Array<double> run() {
    Array<double> trace{{options_.frames, options_.objects, 7}, {}};
    trace.data.reserve(options_.frames * options_.objects * 7);
    build_maze();
    Place start = end_place(-1), goal = end_place(1);
    while (!done(trace)) {
      tree_.assign(1, start);
      while (!done(trace) && !grow(goal, trace)) {
      }
      std::swap(start, goal);
    }
    return trace;
  }

 private:
  bool done(const Array<double>& trace) const {
    return trace.data.size() == options_.frames * options_.objects * 7;
  }

  const Extent& mesh_of(std::size_t object) const { return meshes_[object % meshes_.size()]; }

  Place end_place(int end) const {
    Place place;
    place.centre = {end * half_side_, 0, 0};
    return place;
  }

  /// Obstacles leave the two ends free.
  void build_maze() {
    poses_.clear();
    for (std::size_t object = 0; object < robot_; ++object)
      for (int tries = 0;; ++tries) {
        need(tries < 1000, "side: no room for obstacle " + std::to_string(object));
        const Place place = anywhere();
        poses_.resize(object);
        poses_.push_back(bvlab::pose_of(place, mesh_of(object)));
        if (!meets_end(place, object)) {
          maze_.push_back(place);
          break;
        }
      }
    poses_.push_back(Pose{});
  }
  bool meets_end(const Place& place, std::size_t object) const {
    const double apart = mesh_of(object).radius + mesh_of(robot_).radius;
    return (place.centre - end_place(-1).centre).norm() < apart ||
           (place.centre - end_place(1).centre).norm() < apart;
  }

  Place anywhere() { return bvlab::anywhere(random_, half_side_); }

  /// One run of steps; whether the goal has been reached.
  bool grow(const Place& goal, Array<double>& trace) {
    const bool to_goal = random_.happens(0.1);
    const Place target = to_goal ? goal : anywhere();
    Place at = *std::min_element(tree_.begin(), tree_.end(), [&](const Place& a, const Place& b) {
      return distance(a, target) < distance(b, target);
    });
    while (!done(trace)) {
      const auto [next, arrived] = towards(at, target);
      if (!is_free(next, trace)) return false;
      tree_.push_back(at = next);
      if (arrived) return to_goal;
    }
    return false;
  }

  double distance(const Place& a, const Place& b) const {
    return (a.centre - b.centre).norm() + mesh_of(robot_).radius * 2 * chord(a, b);
  }
  /// Between the unit quaternions or their opposites, which are the same turn.
  static double chord(const Place& a, const Place& b) {
    double same = 0, opposite = 0;
    for (int k = 0; k < 4; ++k) {
      const double d = a.attitude[k] - b.attitude[k], s = a.attitude[k] + b.attitude[k];
      same += d * d, opposite += s * s;
    }
    return std::sqrt(std::min(same, opposite));
  }

  struct Step {
    Place place;
    bool arrived;
  };
  /// Along the straight line, and along the chord between the attitudes: a step turns by the angle
  /// of its share of the chord.
  Step towards(const Place& from, const Place& to) const {
    double dot = 0;
    for (int k = 0; k < 4; ++k) dot += from.attitude[k] * to.attitude[k];
    const double sign = dot < 0 ? -1 : 1;
    const double steps = std::max({1.0, std::ceil((to.centre - from.centre).norm() / step_),
                                   chord_ > 0 ? std::ceil(chord(from, to) / chord_) : 1.0});
    if (steps == 1) return {to, true};
    Place place;
    place.centre = from.centre + (to.centre - from.centre) / steps;
    for (int k = 0; k < 4; ++k)
      place.attitude[k] = from.attitude[k] + (sign * to.attitude[k] - from.attitude[k]) / steps;
    place.attitude = normalised(place.attitude);
    return {place, false};
  }

  /// Queries a pose, and adds it to the trace.
  bool is_free(const Place& place, Array<double>& trace) {
    for (std::size_t object = 0; object < robot_; ++object)
      append(trace.data, maze_[object], mesh_of(object));
    append(trace.data, place, mesh_of(robot_));
    poses_[robot_] = bvlab::pose_of(place, mesh_of(robot_));
    return !touches_(robot_, poses_);
  }

  const Planner& options_;
  std::span<const Extent> meshes_;
  const TouchesAny& touches_;
  double half_side_, step_, chord_ = 0;
  std::size_t robot_;
  Random random_;
  std::vector<Place> maze_, tree_;
  std::vector<Pose> poses_;
};

}  // namespace

void Planner::check() const {
  need(objects > 0, "objects: there must be a robot");
  need(degrees >= 0 && degrees <= 180, "degrees: must be 0 to 180");
  need_few_poses(frames, objects);
}

Array<double> Planner::generate(std::span<const Extent> meshes, const TouchesAny& touches) const {
  check();
  need(!meshes.empty(), "no mesh to move");
  need(static_cast<bool>(touches), "planner: nothing to look for contacts with");
  return Search(*this, meshes, touches).run();
}

}  // namespace bvlab
