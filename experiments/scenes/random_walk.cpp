// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/random_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/circle.hpp"
#include "experiments/scenes/places.hpp"

namespace bvlab {
namespace {

/// One step: a displacement of the centre and a turn about it.
struct Step {
  Vec3<double> shift = Vec3<double>::Zero();
  Quaternion turn = {1, 0, 0, 0};
  bool turns = false;
};

class Walk {
 public:
  Walk(const RandomWalk& options, std::span<const Extent> meshes, const TouchesAny& touches)
      : options_(options),
        meshes_(meshes),
        touches_(touches),
        rejects_(options.contact == "reject"),
        one_freedom_(options.freedoms == "one"),
        half_side_(resolved(options.side, meshes, "side") / 2),
        step_(resolved(options.step, meshes, "step")),
        random_(options.seed) {
    const auto [cosine, sine] = cosine_sine(options.degrees / 720);
    half_cosine_ = cosine, half_sine_ = sine;
    need(std::isfinite(2 * half_side_ + step_), "side, step: too large");
    need(step_ <= 2 * half_side_,
         "step: longer than the side of the cube, " + std::to_string(2 * half_side_));
  }

  Array<double> run() {
    Array<double> trace{{options_.frames, options_.objects, 7}, {}};
    if (options_.frames == 0) return trace;
    trace.data.reserve(options_.frames * options_.objects * 7);
    start();
    append(trace.data);
    order_.resize(options_.objects);
    for (std::size_t frame = 1; frame < options_.frames; ++frame) {
      advance();
      append(trace.data);
    }
    return trace;
  }

 private:
  void start() {
    places_.resize(options_.objects);
    last_.resize(options_.objects);
    // Bodies not placed yet are not among the poses, so they touch nothing.
    for (std::size_t object = 0; object < options_.objects; ++object) {
      places_[object] = anywhere();
      if (!rejects_) continue;
      poses_.push_back(pose_of(object));
      for (int tries = 1; touches_(object, poses_); ++tries) {
        need(tries < 1000, "side: no room for body " + std::to_string(object) +
                               " to start without touching another, in 1000 tries");
        places_[object] = anywhere();
        poses_[object] = pose_of(object);
      }
    }
  }

  void advance() {
    if (options_.teleport > 0 && options_.objects > 0 && random_.happens(options_.teleport))
      teleport(random_.below(options_.objects));
    for (const std::size_t object : movers()) {
      const Step step =
          last_[object] && random_.happens(options_.persistence) ? *last_[object] : drawn();
      last_[object] = attempt(object, step);
    }
  }

  /// The bodies that make a step now: the first of a random order, in the order of their numbers.
  std::span<const std::size_t> movers() {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const std::size_t n = order_.size(), moving = options_.moving == 0 ? n : options_.moving;
    if (moving == n) return order_;
    for (std::size_t i = 0; i < moving; ++i) std::swap(order_[i], order_[i + random_.below(n - i)]);
    std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(moving));
    return std::span(order_).first(moving);
  }

  Step drawn() {
    Step step;
    if (one_freedom_) {
      const std::uint64_t choice = random_.below(12);
      const int axis = static_cast<int>(choice / 2 % 3);
      const double sign = choice % 2 ? -1 : 1;
      if (choice < 6) {
        step.shift[axis] = sign * step_;
      } else {
        step.turns = true;
        step.turn = {half_cosine_, 0, 0, 0};
        step.turn[static_cast<std::size_t>(axis) + 1] = sign * half_sine_;
      }
      return step;
    }
    const Vec3<double> heading = random_.direction(), axis = random_.direction();
    for (int d = 0; d < 3; ++d) step.shift[d] = step_ * heading[d];
    step.turns = true;
    step.turn = {half_cosine_, half_sine_ * axis[0], half_sine_ * axis[1], half_sine_ * axis[2]};
    return step;
  }

  /// Makes the step if it may be made; what may be repeated next time.
  std::optional<Step> attempt(std::size_t object, Step step) {
    const Place before = places_[object];
    Place& place = places_[object];
    for (int d = 0; d < 3; ++d) {
      double x = place.centre[d] + step.shift[d];
      const double wall = x > half_side_ ? half_side_ : -half_side_;
      if (x > half_side_ || x < -half_side_) {
        // A step is no longer than the cube is wide; rounding may still graze the other wall.
        x = std::clamp(wall + (wall - x), -half_side_, half_side_);
        step.shift[d] = -step.shift[d];
      }
      place.centre[d] = x;
    }
    if (step.turns) place.attitude = normalised(product(step.turn, place.attitude));
    if (!rejects_) return step;
    const Pose stood = poses_[object];
    poses_[object] = pose_of(object);
    if (!touches_(object, poses_)) return step;
    place = before;
    poses_[object] = stood;
    return std::nullopt;
  }

  void teleport(std::size_t object) {
    const Place before = places_[object];
    last_[object].reset();
    places_[object] = anywhere();
    if (!rejects_) return;
    const Pose stood = poses_[object];
    for (int tries = 1;; ++tries) {
      poses_[object] = pose_of(object);
      if (!touches_(object, poses_)) return;
      if (tries == 1000) break;
      places_[object] = anywhere();
    }
    places_[object] = before;
    poses_[object] = stood;
  }

  Place anywhere() { return bvlab::anywhere(random_, half_side_); }

  const Extent& mesh_of(std::size_t object) const { return meshes_[object % meshes_.size()]; }
  Pose pose_of(std::size_t object) const {
    return bvlab::pose_of(places_[object], mesh_of(object));
  }

  void append(std::vector<double>& data) const {
    for (std::size_t object = 0; object < options_.objects; ++object)
      bvlab::append(data, places_[object], mesh_of(object));
  }

  const RandomWalk& options_;
  std::span<const Extent> meshes_;
  const TouchesAny& touches_;
  bool rejects_, one_freedom_;
  double half_side_, step_;
  double half_cosine_ = 1, half_sine_ = 0;
  Random random_;
  std::vector<Place> places_;
  std::vector<Pose> poses_;  // of places_; kept where contacts are looked for
  std::vector<std::optional<Step>> last_;
  std::vector<std::size_t> order_;
};

}  // namespace

void RandomWalk::check() const {
  need(freedoms == "one" || freedoms == "all", "freedoms '" + freedoms + "'; available: one, all");
  need(contact == "pass" || contact == "reject",
       "contact '" + contact + "'; available: pass, reject");
  need(moving <= objects,
       "moving: " + std::to_string(moving) + " of " + std::to_string(objects) + " bodies");
  need(degrees >= 0 && degrees <= 180, "degrees: must be 0 to 180");
  need(persistence >= 0 && persistence <= 1, "persistence: must be 0 to 1");
  need(teleport >= 0 && teleport <= 1, "teleport: must be 0 to 1");
  need_few_poses(frames, objects);
}

Array<double> RandomWalk::generate(std::span<const Extent> meshes,
                                   const TouchesAny& touches) const {
  check();
  need(!meshes.empty(), "no mesh to move");
  need(contact == "pass" || touches, "contact: nothing to look for contacts with");
  return Walk(*this, meshes, touches).run();
}

}  // namespace bvlab
