// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/pile.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "experiments/scenes/places.hpp"

namespace bvlab {
namespace {

constexpr int substeps = 4;
constexpr double dt = 1.0 / 60 / substeps;
constexpr int rounds = 4;           // of corrections in a substep
constexpr int frames_to_rest = 30;  // half a second
constexpr double gravity = 20;      // radii per second squared
constexpr double slow = 0.05;       // radii per second: hardly moving
constexpr double damping = 0.998;   // of velocities, each substep: air
constexpr double grip = 0.2;        // of what slides, each substep in contact

struct Ball {
  Vec3<double> at, was, velocity = Vec3<double>::Zero(), spin = Vec3<double>::Zero();
  double radius;
  int still = 0;  ///< frames in which it hardly moved
  bool asleep = false;
};

class Simulation {
 public:
  Simulation(const Pile& options, std::span<const Extent> meshes)
      : options_(options),
        meshes_(meshes),
        half_side_(resolved(options.side, meshes, "side") / 2),
        random_(options.seed) {
    for (const Extent& mesh : meshes) largest_ = std::max(largest_, mesh.radius * options.core);
    need(largest_ > 0 && std::isfinite(half_side_), "side, meshes: must have an extent");
    need(half_side_ >= largest_, "side: narrower than a body");
  }

  Array<double> run() {
    Array<double> trace{{options_.frames, options_.objects, 7}, {}};
    if (options_.frames == 0) return trace;
    start();
    append(trace.data);
    for (std::size_t frame = 1; frame < options_.frames; ++frame) {
      for (const Ball& ball : balls_) frame_start_.push_back(ball.at);
      for (int k = 0; k < substeps; ++k) substep();
      rest();
      frame_start_.clear();
      append(trace.data);
    }
    return trace;
  }

 private:
  const Extent& mesh_of(std::size_t object) const { return meshes_[object % meshes_.size()]; }

  /// Layers of a square grid, each shifted a little so that nothing lies exactly above anything.
  void start() {
    const double apart = 2.2 * largest_;
    const auto across = static_cast<std::size_t>(
        std::max(1.0, std::floor((2 * half_side_ - 2 * largest_) / apart)));
    for (std::size_t i = 0; i < options_.objects; ++i) {
      const std::size_t layer = i / (across * across), place = i % (across * across);
      const auto along = [&](std::size_t k) {
        return (static_cast<double>(k) - static_cast<double>(across - 1) / 2) * apart +
               random_.uniform(-0.05, 0.05) * largest_;
      };
      Ball ball;
      const double x = along(place % across), y = along(place / across);
      ball.at = {x, y, largest_ * 1.5 + static_cast<double>(layer) * apart};
      ball.radius = std::max(mesh_of(i).radius * options_.core, 1e-3 * largest_);
      balls_.push_back(ball);
      Place place_now;
      place_now.attitude = random_.rotation();
      places_.push_back(place_now);
    }
  }

  void substep() {
    for (Ball& ball : balls_) {
      ball.was = ball.at;
      if (ball.asleep) continue;
      ball.velocity[2] -= gravity * largest_ * dt;
      ball.velocity *= damping;
      ball.at += ball.velocity * dt;
    }
    find_near();
    for (int round = 0; round < rounds; ++round) correct();
    for (Ball& ball : balls_)
      if (!ball.asleep) ball.velocity = (ball.at - ball.was) / dt;
    slide();
    for (std::size_t i = 0; i < balls_.size(); ++i) turn(i);
  }

  /// Pairs that can meet in this substep, by a sweep along x.
  void find_near() {
    order_.resize(balls_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return balls_[a].at[0] != balls_[b].at[0] ? balls_[a].at[0] < balls_[b].at[0] : a < b;
    });
    near_.clear();
    for (std::size_t k = 0; k < order_.size(); ++k)
      for (std::size_t m = k + 1; m < order_.size(); ++m) {
        const Ball &a = balls_[order_[k]], &b = balls_[order_[m]];
        if (b.at[0] - a.at[0] > 2.2 * largest_) break;
        if (a.asleep && b.asleep) continue;
        const double reach = (a.radius + b.radius) * 1.1;
        if ((a.at - b.at).squaredNorm() < reach * reach) near_.push_back({order_[k], order_[m]});
      }
  }

  /// Moves balls apart and into the box. One that sleeps is moved by nobody; it wakes when what
  /// meets it is not slow.
  void correct() {
    for (const auto& [i, j] : near_) {
      Ball &a = balls_[i], &b = balls_[j];
      const Vec3<double> offset = b.at - a.at;
      const double distance = offset.norm(), overlap = a.radius + b.radius - distance;
      if (overlap <= 0 || distance == 0) continue;
      wake_by(a, b), wake_by(b, a);
      const Vec3<double> push = offset / distance * overlap;
      const double share = a.asleep ? 0 : b.asleep ? 1 : 0.5;
      a.at -= push * share;
      b.at += push * (b.asleep ? 0 : 1 - share);
    }
    for (Ball& ball : balls_) {
      if (ball.asleep) continue;
      for (int axis = 0; axis < 2; ++axis)
        ball.at[axis] =
            std::clamp(ball.at[axis], -half_side_ + ball.radius, half_side_ - ball.radius);
      ball.at[2] = std::max(ball.at[2], ball.radius);
    }
  }
  void wake_by(Ball& sleeper, const Ball& other) const {
    if (!sleeper.asleep || other.asleep) return;
    const double speed = (other.at - other.was).norm() / dt;
    if (speed < 20 * slow * largest_) return;
    sleeper.asleep = false;
    sleeper.still = 0;
  }

  /// What slides along what it touches is slowed, and turns as if it rolled.
  void slide() {
    for (const auto& [i, j] : near_) {
      const Vec3<double> offset = balls_[j].at - balls_[i].at;
      const double distance = offset.norm();
      if (distance == 0 || distance > (balls_[i].radius + balls_[j].radius) * 1.001) continue;
      const Vec3<double> towards_j = offset / distance;
      const Vec3<double> relative = balls_[i].velocity - balls_[j].velocity;
      rub(balls_[i], towards_j, relative, 0.5);
      rub(balls_[j], -towards_j, -relative, 0.5);
    }
    for (Ball& ball : balls_)
      if (ball.at[2] <= ball.radius * 1.001) rub(ball, {0, 0, -1}, ball.velocity, 1);
  }
  static void rub(Ball& ball, const Vec3<double>& towards, const Vec3<double>& velocity,
                  double share) {
    if (ball.asleep) return;
    const Vec3<double> along = velocity - towards * velocity.dot(towards);
    ball.velocity -= along * (share * grip * 0.2);
    ball.spin += (towards.cross(along) / ball.radius * -1 - ball.spin) * (share * grip);
  }

  void turn(std::size_t i) {
    Ball& ball = balls_[i];
    if (ball.asleep) return;
    ball.spin *= damping;
    const Vec3<double> half = ball.spin * (dt / 2);
    auto& q = places_[i].attitude;
    q = normalised(product(normalised({1, half[0], half[1], half[2]}), q));
  }

  void rest() {
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      Ball& ball = balls_[i];
      if (ball.asleep) continue;
      const double moved = (ball.at - frame_start_[i]).norm() * 60;
      ball.still = moved < slow * largest_ ? ball.still + 1 : 0;
      if (ball.still < frames_to_rest) continue;
      ball.asleep = true;
      ball.velocity = ball.spin = Vec3<double>::Zero();
    }
  }

  void append(std::vector<double>& data) {
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      places_[i].centre = balls_[i].at;
      bvlab::append(data, places_[i], mesh_of(i));
    }
  }

  const Pile& options_;
  std::span<const Extent> meshes_;
  double half_side_, largest_ = 0;
  Random random_;
  std::vector<Ball> balls_;
  std::vector<Place> places_;
  std::vector<std::size_t> order_;
  std::vector<std::pair<std::size_t, std::size_t>> near_;
  std::vector<Vec3<double>> frame_start_;
};

}  // namespace

void Pile::check() const {
  need(core > 0 && core <= 1, "core: must be above 0 and at most 1");
  need_few_poses(frames, objects);
}

Array<double> Pile::generate(std::span<const Extent> meshes, const TouchesAny&) const {
  check();
  need(!meshes.empty(), "no mesh to move");
  return Simulation(*this, meshes).run();
}

}  // namespace bvlab
