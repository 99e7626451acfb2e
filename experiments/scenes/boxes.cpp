// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/boxes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {
namespace {

using Centre = std::array<float, 3>;

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  float uniform(float lo, float hi) {
    return lo + (hi - lo) * (static_cast<float>(random_() >> 8) * 0x1p-24f);
  }
  float normal() {  // the sum of twelve uniform numbers: the same everywhere, unlike the library's
    float sum = -6;
    for (int k = 0; k < 12; ++k) sum += uniform(0, 1);
    return sum;
  }
  Centre in_cube() { return {uniform(0, 1), uniform(0, 1), uniform(0, 1)}; }
  Centre on_sphere() {
    for (;;) {
      const Centre c{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const float r = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
      if (r > 1 || r < 0.1f) continue;
      return {c[0] / r, c[1] / r, c[2] / r};
    }
  }
  static Box<float> around(const Centre& c, const Centre& extent) {
    Box<float> box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = c[axis] - extent[axis] / 2;
      box.hi[axis] = c[axis] + extent[axis] / 2;
    }
    return box;
  }
  /// Edges from half to one and a half times the size.
  Centre edges(float size) {
    return {size * uniform(0.5f, 1.5f), size * uniform(0.5f, 1.5f), size * uniform(0.5f, 1.5f)};
  }

  std::mt19937& random() { return random_; }

 private:
  std::mt19937 random_;
};

std::vector<Box<float>> adjacent(std::size_t count, Maker& make) {
  auto side = static_cast<std::size_t>(std::cbrt(static_cast<double>(count)) + 1e-9);
  std::vector<Box<float>> boxes;
  for (std::size_t x = 0; x < side; ++x)
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t z = 0; z < side; ++z) {
        const auto a = static_cast<float>(x), b = static_cast<float>(y), c = static_cast<float>(z);
        boxes.push_back({{a, b, c}, {a + 1, b + 1, c + 1}});
      }
  std::shuffle(boxes.begin(), boxes.end(), make.random());
  return boxes;
}

using Corner = std::array<double, 3>;

/// The box of these points.
Box<float> box_of(std::initializer_list<Corner> points) {
  Box<float> box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] =
        std::minmax_element(points.begin(), points.end(),
                            [&](const Corner& a, const Corner& b) { return a[axis] < b[axis]; });
    box.lo[axis] = rounded_down<float>((*least)[axis]);
    box.hi[axis] = rounded_up<float>((*most)[axis]);
  }
  return box;
}

std::vector<Corner> corners_of(const TriangleMesh& mesh) {
  std::vector<Corner> corners;
  for (const auto& v : mesh.vertices) corners.push_back({v[0], v[1], v[2]});
  return corners;
}

/// The boxes of a mesh's triangles: neighbours share corners, so each touches a dozen others.
std::vector<Box<float>> triangles(std::size_t count) {
  const TriangleMesh mesh = named_mesh("bunny", std::max<std::size_t>(count, 4)).mesh;
  const auto at = corners_of(mesh);
  std::vector<Box<float>> boxes;
  for (const auto& [i, j, k] : mesh.triangles) boxes.push_back(box_of({at[i], at[j], at[k]}));
  if (boxes.size() > count) boxes.resize(count);
  return boxes;
}

/// The boxes of a mesh's edges, each as it sweeps from where its corners are to where they go.
std::vector<Box<float>> swept_edges(const std::vector<Corner>& from, const std::vector<Corner>& to,
                                    const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::set<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.insert({low, high});
    }
  std::vector<Box<float>> boxes;
  for (const auto& [a, b] : edges) boxes.push_back(box_of({from[a], from[b], to[a], to[b]}));
  return boxes;
}

/// Smooth, from -1 to 1, once round as x goes on by one: parabolas, the same everywhere.
double wave(double x) {
  x -= std::floor(x);
  const double u = x < 0.5 ? x : x - 0.5, height = 16 * u * (0.5 - u);
  return x < 0.5 ? height : -height;
}

std::vector<Box<float>> swept_bunny(std::size_t count) {
  const TriangleMesh mesh = named_mesh("bunny", std::max<std::size_t>(2 * count / 3, 4)).mesh;
  const std::vector<Corner> from = corners_of(mesh);
  std::vector<Corner> to;
  double length = 0, size = 0;
  for (const auto& t : mesh.triangles)
    for (int axis = 0; axis < 3; ++axis) {
      length += std::abs(from[t[0]][axis] - from[t[1]][axis]) /
                static_cast<double>(2 * mesh.triangles.size());  // two such differences an edge
      size = std::max(size, std::abs(from[t[0]][axis]));
    }
  for (const Corner& v : from) {
    Corner moved = v;
    for (int axis = 0; axis < 3; ++axis)
      moved[axis] += 4.5 * length * wave(0.3 * axis + v[(axis + 1) % 3] / (2 * size));
    to.push_back(moved);
  }
  auto boxes = swept_edges(from, to, mesh.triangles);
  if (boxes.size() > count) boxes.resize(count);
  return boxes;
}

/// Folds: waves across the unit square in random directions.
class Folds {
 public:
  explicit Folds(Maker& make) {
    for (Fold& fold : folds_)
      fold = {1.9 * make.normal(),
              1.9 * make.normal(),
              make.uniform(0, 1),
              {0.06 * make.normal(), 0.06 * make.normal(), 0.06 * make.normal()}};
  }
  Corner operator()(double u, double v) const {
    Corner sum{};
    for (const Fold& fold : folds_)
      for (int axis = 0; axis < 3; ++axis)
        sum[axis] += fold.height[axis] * wave(fold.along * u + fold.across * v + fold.phase);
    return sum;
  }

 private:
  struct Fold {
    double along, across, phase;
    Corner height;
  };
  std::array<Fold, 10> folds_;
};

/// A sheet of side x side corners and two triangles to a square, crumpled a little.
std::vector<Box<float>> cloth(std::size_t count, Maker& make) {
  std::uint32_t side = 2;
  while (3 * std::size_t{side + 1} * (side + 1) - 4 * (side + 1) + 1 <= count) ++side;
  const Folds shape(make), motion(make);
  std::vector<Corner> from, to;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const double step = 1.0 / side;
  for (std::uint32_t k = 0; k < side * side; ++k) {
    const double u = step * (k / side), v = step * (k % side);
    Corner corner = shape(u, v);
    const Corner moves = motion(u, v);
    corner[0] += u, corner[1] += v;
    for (double& x : corner) x += 0.2 * step * make.normal();
    from.push_back(corner);
    for (int axis = 0; axis < 3; ++axis) corner[axis] += 35 * step * moves[axis];
    to.push_back(corner);
    if (k / side + 1 == side || k % side + 1 == side) continue;
    triangles.push_back({k, k + side, k + 1});
    triangles.push_back({k + side, k + side + 1, k + 1});
  }
  auto boxes = swept_edges(from, to, triangles);
  if (boxes.size() > count) boxes.resize(count);
  return boxes;
}

}  // namespace

std::vector<std::string> box_set_names() {
  return {"random",      "sphere-packed", "adjacent",  "sphere-sparse", "clusters",
          "mixed",       "elongated",     "flock",     "pile",          "triangles",
          "swept-edges", "cloth",         "uniform-1", "uniform-8",     "uniform-64"};
}
std::vector<std::string> box_motion_names() {
  return {"still", "drift", "rigid",      "breathe", "part",   "same",    "few",
          "rare",  "jump",  "accelerate", "reverse", "jitter", "teleport"};
}

std::vector<Box<float>> make_box_set(const std::string& name, std::size_t count, unsigned seed) {
  Maker make(seed);
  if (name == "adjacent") return adjacent(count, make);
  if (name == "triangles") return triangles(count);
  if (name == "swept-edges") return swept_bunny(count);
  if (name == "cloth") return cloth(count, make);
  const float spacing = 1 / std::cbrt(static_cast<float>(std::max<std::size_t>(count, 1)));
  std::vector<Centre> centres;
  centres.reserve(20);
  for (int k = 0; k < 20; ++k) centres.push_back(make.in_cube());
  const auto one = [&]() -> Box<float> {
    if (name == "random") return make.around(make.in_cube(), make.edges(0.095f));
    if (name == "sphere-packed") return make.around(make.on_sphere(), make.edges(0.08f));
    if (name == "sphere-sparse")
      return make.around(make.on_sphere(), make.edges(2.4f / std::sqrt(static_cast<float>(count))));
    if (name == "clusters") {
      const Centre& c = centres[make.random()() % centres.size()];
      return make.around({c[0] + 0.02f * make.normal(), c[1] + 0.02f * make.normal(),
                          c[2] + 0.02f * make.normal()},
                         make.edges(0.15f * spacing));
    }
    if (name == "mixed")
      return make.around(make.in_cube(),
                         make.edges(5 * spacing * std::pow(10.0f, -6 * make.uniform(0, 1))));
    if (name == "elongated") {
      Centre extent = make.edges(0.2f * spacing);
      extent[make.random()() % 3] *= 20;
      return make.around(make.in_cube(), extent);
    }
    if (name == "flock") return make.around(make.in_cube(), make.edges(0.8f * spacing));
    for (const int overlapped :
         {1, 8, 64})  // edges a and b overlap where centres are (a + b) / 2 apart
      if (name == "uniform-" + std::to_string(overlapped))
        return make.around(make.in_cube(),
                           make.edges(0.5f * std::cbrt(static_cast<float>(overlapped)) * spacing));
    if (name == "pile") {  // heaped towards the floor
      Centre c = make.in_cube();
      c[2] *= 0.3f * c[2];
      return make.around(c, make.edges(0.5f * spacing));
    }
    throw Unusable("set " + name + ": unknown; available: " + joined(box_set_names()));
  };
  std::vector<Box<float>> boxes;
  boxes.reserve(count);
  for (std::size_t k = 0; k < count; ++k) boxes.push_back(one());
  return boxes;
}

BoxMotion::BoxMotion(std::string motion, double displacement, const std::string& set,
                     std::vector<Box<float>> boxes, unsigned seed)
    : motion_(std::move(motion)),
      displacement_(static_cast<float>(displacement)),
      start_(boxes),
      boxes_(std::move(boxes)),
      random_(seed + 1),
      jitter_(seed + 3) {
  if (const auto known = box_motion_names();
      std::find(known.begin(), known.end(), motion_) == known.end())
    throw Unusable("motion " + motion_ + ": unknown");
  Maker make(seed + 2);
  const std::size_t every = motion_ == "part"                     ? 100
                            : motion_ == "same"                   ? 50
                            : set == "pile" && motion_ == "drift" ? 50
                                                                  : 1;
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    Centre v{make.uniform(-1, 1), make.uniform(-1, 1), make.uniform(-1, 1)};
    if (set == "flock") v = {1 + 0.1f * v[0], 0.5f + 0.1f * v[1], 0.1f * v[2]};
    if (motion_ == "rigid") v = {1, 0.7f, -0.4f};
    velocity_.push_back(v);
    if (make.random()() % every == 0) movers_.push_back(k);
  }
  const std::size_t divisor = motion_ == "few"    ? 50
                              : motion_ == "rare" ? 1000
                              : motion_ == "jump" ? 10
                                                  : 0;
  if (divisor == 0) return;
  // In turn, in an order that is as good as any.
  std::shuffle(movers_.begin(), movers_.end(), make.random());
  in_turn_ = std::min(boxes_.size(), boxes_.size() / divisor + 1);
}

void BoxMotion::step() {
  ++frame_;
  if (motion_ == "still") return;
  if (motion_ == "teleport") return std::shuffle(boxes_.begin(), boxes_.end(), random_);
  constexpr int frames_to_speed = 8, frames_to_reversal = 4;
  // From rest to a steady speed and beyond; and to and fro.
  const float speed = motion_ == "accelerate" ? static_cast<float>(frame_) / frames_to_speed
                      : motion_ == "reverse" && (frame_ - 1) / frames_to_reversal % 2 == 1 ? -1.0f
                                                                                           : 1.0f;
  if (in_turn_ > 0) return step_in_turn();
  for (const std::size_t k : movers_)
    if (motion_ == "jitter") {
      for (int axis = 0; axis < 3; ++axis) {
        const float extent = start_[k].hi[axis] - start_[k].lo[axis];
        const float to_one = static_cast<float>(jitter_() >> 8) * 0x1p-24f;
        const float by = (2 * to_one - 1) * displacement_ * extent;
        boxes_[k].lo[axis] = start_[k].lo[axis] + by, boxes_[k].hi[axis] = start_[k].hi[axis] + by;
      }
    } else if (motion_ == "breathe") {
      const std::size_t axis = k % 3;
      Box<float>& box = boxes_[k];
      const float extent = start_[k].hi[axis] - start_[k].lo[axis];
      box.hi[axis] =
          start_[k].hi[axis] +
          extent * 0.5f * std::abs(std::sin(static_cast<float>(frame_) * displacement_ * 2));
    } else {
      drift(k, speed);
    }
}

void BoxMotion::step_in_turn() {
  const auto mover = [&](std::size_t turn) { return movers_[(next_ + turn) % movers_.size()]; };
  if (motion_ == "jump") {
    const Box<float> first = boxes_[mover(0)];
    for (std::size_t turn = 0; turn + 1 < in_turn_; ++turn)
      boxes_[mover(turn)] = boxes_[mover(turn + 1)];
    boxes_[mover(in_turn_ - 1)] = first;
  } else {
    for (std::size_t turn = 0; turn < in_turn_; ++turn) drift(mover(turn), 1);
  }
  next_ += in_turn_;
}

void BoxMotion::drift(std::size_t k, float speed) {
  Box<float>& box = boxes_[k];
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = start_[k].hi[axis] - start_[k].lo[axis];
    float by = velocity_[k][static_cast<std::size_t>(axis)] * displacement_ * extent * speed;
    if (std::abs(box.lo[axis] + by - start_[k].lo[axis]) > 5 * extent)
      velocity_[k][static_cast<std::size_t>(axis)] *= -1, by = -by;
    box.lo[axis] += by;
    box.hi[axis] += by;
  }
}

}  // namespace bvlab
