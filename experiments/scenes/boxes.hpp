// SPDX-License-Identifier: BSD-3-Clause
/// Built-in sets of boxes and how they move, the same for the same seed. Sets of
/// koziara2005bounding: `random` (over-packed, k = O(n^2)), `sphere-packed` (the same on a sphere),
/// `adjacent` (cubes that touch exactly), `sphere-sparse` (k = O(n)). Sets it left out: `clusters`,
/// `mixed` (sizes over six decades), `elongated`, `flock` (velocities correlated), `pile` (most
/// boxes at rest), `uniform-C` (each box overlaps C others in the mean, of any number: k = nC/2); and
/// real ones: `triangles`, the boxes of a bunny's triangles; `swept-edges`,
/// those of its edges, each swept by a motion of three edge lengths, and `cloth`, the same of a
/// crumpled sheet, as continuous collision detection asks for them (some forty pairs a box).
#pragma once

#include <array>
#include <random>
#include <string>
#include <vector>

#include "broadphase/box.hpp"

namespace bvlab {

std::vector<std::string> box_set_names();

/// `adjacent` has as many boxes as the largest cube of cubes within `count`, `cloth` as the largest
/// square sheet; the others have `count`, or what their mesh has to give. Throws Unusable for an
/// unknown name.
std::vector<Box<float>> make_box_set(const std::string& name, std::size_t count, unsigned seed);

/// Moves a set frame by frame:
///   still     nothing moves;
///   drift     every box with a velocity of its own, `displacement` of its size a frame, turning
///             back after five sizes (`flock`: nearly the same velocity for all; `pile`: one box in
///             fifty);
///   rigid     all by the same translation;
///   breathe   boxes grow and shrink along one axis each;
///   part      one box in a hundred drifts;
///   same      two boxes in a hundred drift, always the same;
///   few       two boxes in a hundred drift by a step, in every frame others;
///   rare      as few, one box in a thousand;
///   jump      as few, one box in ten: they take each other's places;
///   accelerate  as drift, from rest, faster by an eighth of that in every frame;
///   reverse   as drift, but all turn round after every fourth frame;
///   jitter    every box stands somewhere within `displacement` of its size from its start, anew in
///             every frame;
///   teleport  every box takes the place of another.
class BoxMotion {
 public:
  BoxMotion(std::string motion, double displacement, const std::string& set,
            std::vector<Box<float>> boxes, unsigned seed);
  const std::vector<Box<float>>& boxes() const { return boxes_; }
  void step();

 private:
  /// With `speed` times the velocity it has.
  void drift(std::size_t k, float speed);
  void step_in_turn();

  std::string motion_;
  float displacement_;
  std::vector<Box<float>> start_, boxes_;
  std::vector<std::array<float, 3>> velocity_;
  std::vector<std::size_t> movers_;
  std::size_t in_turn_ = 0, next_ = 0;  ///< movers of a frame, where not all are; the first of them
  std::mt19937 random_, jitter_;
  int frame_ = 0;
};

std::vector<std::string> box_motion_names();

}  // namespace bvlab
