// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/stressors.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/posed_triangles.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

using Vector = Vec3<double>;
using Quaternion = Eigen::Quaterniond;

class Stage {
 public:
  Stage(std::size_t frames, std::uint64_t seed) : random_(seed) {
    case_.trace.frames = frames, case_.trace.objects = 2;
  }

  double uniform(double low = -1, double high = 1) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Vector point() {
    const double x = uniform(), y = uniform(), z = uniform();
    return {x, y, z};
  }
  Quaternion rotation() {
    const double w = uniform(), x = uniform(), y = uniform(), z = uniform();
    return Quaternion(w, x, y, z).normalized();
  }

  void mesh(TriangleMesh mesh) { case_.meshes.push_back(std::move(mesh)); }

  void frame(const Quaternion& turn_a, const Vector& move_a, const Quaternion& turn_b,
             const Vector& move_b) {
    for (const auto& [turn, move] : {std::pair(turn_a, move_a), std::pair(turn_b, move_b)})
      for (const double x : {move[0], move[1], move[2], turn.w(), turn.x(), turn.y(), turn.z()})
        case_.trace.values.push_back(x);
  }

  /// Where b has to be moved so that the corner of it that is foremost against a face of a lies in
  /// that face, up to rounding and `lift` along the face's normal.
  Vector against(const Quaternion& turn_a, const Vector& move_a, const Quaternion& turn_b,
                 double lift) {
    const TriangleMesh& a = case_.meshes[0];
    const TriangleMesh& b = case_.meshes[1];
    const Pose pose_a = pose_from(move_a, turn_a.w(), turn_a.x(), turn_a.y(), turn_a.z()).value();
    const Pose pose_b =
        pose_from(Vector::Zero(), turn_b.w(), turn_b.x(), turn_b.y(), turn_b.z()).value();
    const Triangle face =
        a.corners(static_cast<std::size_t>(below(static_cast<int>(a.triangles.size()))));
    const Vector p = pose_a(face[0]), q = pose_a(face[1]), r = pose_a(face[2]);
    double s = uniform(0, 1), t = uniform(0, 1) * (1 - s);
    if (below(4) == 0) t = 0;
    if (below(6) == 0) s = 0;
    // Lengths may be so small or large that products leave the numbers.
    const double length = (q - p).cwiseAbs().maxCoeff() + (r - p).cwiseAbs().maxCoeff();
    const Vector u = (q - p) / length, v = (r - p) / length;
    Vector normal = u.cross(v);
    if (normal.norm() > 0) normal.normalize();
    Vector foremost = pose_b(b.vertices[0]);
    for (const auto& vertex : b.vertices) {
      const Vector w = pose_b(vertex);
      if ((w - foremost).dot(normal) < 0) foremost = w;
    }
    return p + s * (q - p) + t * (r - p) + lift * normal - foremost;
  }

  StressCase take() { return std::move(case_); }

 private:
  StressCase case_;
  std::mt19937_64 random_;
};

TriangleMesh scaled(TriangleMesh mesh, const Vector& by) {
  for (auto& v : mesh.vertices) v = v.cwiseProduct(by);
  return mesh;
}
TriangleMesh scaled(TriangleMesh mesh, double by) {
  return scaled(std::move(mesh), Vector(by, by, by));
}

/// The cube of side 2 with each face in two triangles.
TriangleMesh cube() { return scaled(formula_mesh("box", 12), 2); }
TriangleMesh ball() { return formula_mesh("icosphere", 80); }
TriangleMesh star() { return formula_mesh("star", 60); }

/// Nothing, a last digit, or a little, to either side; for things of size 1 at a distance of `far`.
double hair(Stage& stage, double far = 1) {
  const double grain = std::ldexp(1 + far, -52);
  const double sizes[] = {0, 0, grain, 16 * grain, 1e-12 * (1 + far), 1e-6};
  const double size = sizes[stage.below(6)];
  return stage.below(2) ? size : -size;
}

/// Bodies of size `scale_a` and `scale_b`, turned at random, `far` from the origin, b's foremost
/// corner on a's face.
StressCase touching_bodies(std::size_t frames, std::uint64_t seed, double far, double scale_a,
                           double scale_b, const Vector& flatten = Vector(1, 1, 1)) {
  Stage stage(frames, seed);
  stage.mesh(scaled(scaled(ball(), flatten), scale_a));
  stage.mesh(scaled(scaled(star(), flatten), scale_b));
  for (std::size_t i = 0; i < frames; ++i) {
    const Quaternion a = stage.rotation(), b = stage.rotation();
    const Vector move = far * stage.point();
    const double lift = std::min(scale_a, scale_b) * hair(stage, far / std::min(scale_a, scale_b));
    stage.frame(a, move, b, stage.against(a, move, b, lift));
  }
  return stage.take();
}

StressCase far_away(double level, std::size_t frames, std::uint64_t seed) {
  return touching_bodies(frames, seed, level, 1, 1);
}
StressCase any_scale(double level, std::size_t frames, std::uint64_t seed) {
  return touching_bodies(frames, seed, 0, level, level);
}
StressCase mixed(double level, std::size_t frames, std::uint64_t seed) {
  return touching_bodies(frames, seed, 0, level, 1 / level);
}
StressCase slivers(double level, std::size_t frames, std::uint64_t seed) {
  return touching_bodies(frames, seed, 0, 1, 1, Vector(1, level, 1));
}
StressCase needles(double level, std::size_t frames, std::uint64_t seed) {
  return touching_bodies(frames, seed, 0, 1, 1, Vector(1, level, level));
}

/// Cubes on each other like bricks, faces in one plane, both turned alike (level 1) or not at all;
/// or a last digit between them.
StressCase stacks(double level, std::size_t frames, std::uint64_t seed) {
  Stage stage(frames, seed);
  stage.mesh(cube());
  stage.mesh(cube());
  for (std::size_t i = 0; i < frames; ++i) {
    const Quaternion turn = level > 0 ? stage.rotation() : Quaternion::Identity();
    const double hairs[] = {0, 0, 0x1p-50, -0x1p-50};
    const Vector move(stage.below(9) / 4.0 - 1, stage.below(9) / 4.0 - 1,
                      2 + hairs[stage.below(4)]);
    stage.frame(turn, Vector::Zero(), turn, turn * move);
  }
  return stage.take();
}

/// A mesh cut in two along edges, both halves posed alike: they share corners and edges as
/// neighbours in a mesh do. Level: how far the second is moved away, in last digits.
StressCase neighbours(double level, std::size_t frames, std::uint64_t seed) {
  Stage stage(frames, seed);
  const TriangleMesh whole = ball();
  TriangleMesh halves[2];
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    TriangleMesh& half = halves[whole.corners(t)[0].sum() + whole.corners(t)[1].sum() > 0.3];
    half.triangles.push_back(whole.triangles[t]);
  }
  for (auto& half : halves) {
    half.vertices = whole.vertices;
    stage.mesh(half);
  }
  for (std::size_t i = 0; i < frames; ++i) {
    const Quaternion turn = stage.rotation();
    const Vector move = 3 * stage.point();
    stage.frame(turn, move, turn, move + level * 0x1p-51 * stage.point());
  }
  return stage.take();
}

/// Cubes with whole coordinates that touch exactly in a point, along an edge, or in a face (level
/// 0, 1, 2), or are a last digit apart or inside.
StressCase exactly(double level, std::size_t frames, std::uint64_t seed) {
  Stage stage(frames, seed);
  stage.mesh(cube());
  stage.mesh(cube());
  for (std::size_t i = 0; i < frames; ++i) {
    Vector move(2, 2, 2);
    for (int axis = 0; axis < static_cast<int>(level); ++axis)
      move[axis] = stage.below(2) ? 1 : 0.5;
    const double hairs[] = {0, 0, 0x1p-51, -0x1p-51};
    move[2] += hairs[stage.below(4)];
    for (int axis = 0; axis < 3; ++axis)
      if (stage.below(2)) move[axis] = -move[axis];
    std::swap(move[0], move[stage.below(3)]);
    stage.frame(Quaternion::Identity(), Vector::Zero(), Quaternion::Identity(), move);
  }
  return stage.take();
}

/// One cube slides over another, a step of 1e-3 a frame, at a height that is right up to the last
/// digits; both turned alike by a rotation of its own for the run (level 1) or not at all.
StressCase grazing(double level, std::size_t frames, std::uint64_t seed) {
  Stage stage(frames, seed);
  stage.mesh(cube());
  stage.mesh(ball());
  const Quaternion turn = level > 0 ? stage.rotation() : Quaternion::Identity();
  double bottom = 0;
  for (const auto& v : ball().vertices) bottom = std::min(bottom, v[2]);
  for (std::size_t i = 0; i < frames; ++i) {
    const double along = 1e-3 * static_cast<double>(i);
    const double height = 1 - bottom + stage.below(5) * 0x1p-52 - 0x1p-51;
    stage.frame(turn, Vector::Zero(), turn, turn * Vector(along, 0.3 * along, height));
  }
  return stage.take();
}

/// A rotation multiplied `level` times by a small one, never normalised.
StressCase composed(double level, std::size_t frames, std::uint64_t seed) {
  Stage stage(frames, seed);
  stage.mesh(ball());
  stage.mesh(star());
  Quaternion turn = stage.rotation();
  const Quaternion step(Eigen::AngleAxisd(0.01, stage.point().normalized()));
  for (double i = 0; i < level; ++i) turn = turn * step;
  for (std::size_t i = 0; i < frames; ++i) {
    turn = turn * step;
    const Quaternion other = stage.rotation();
    stage.frame(turn, Vector::Zero(), other,
                stage.against(turn, Vector::Zero(), other, hair(stage)));
  }
  return stage.take();
}

constexpr double offsets[] = {1e0, 1e2, 1e4, 1e6, 1e8};
constexpr double scales[] = {1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9};
constexpr double flatness[] = {1e-3, 1e-8, 1e-15, 0};
constexpr double turned[] = {0, 1};
constexpr double digits[] = {0, 1, 1e6};
constexpr double contacts[] = {0, 1, 2};
constexpr double chains[] = {1e3, 1e6};
constexpr double least[] = {1e-150, 1e-300, 1e-310};
constexpr double ratios[] = {1e2, 1e4, 1e6};

constexpr Stressor list[] = {
    {"offset", "touching bodies so far from the origin", offsets, far_away},
    {"scale", "touching bodies of that size", scales, any_scale},
    {"slivers", "touching bodies flattened to that", flatness, slivers},
    {"needles", "touching bodies thinned to that", flatness, needles},
    {"stacks", "cubes on each other, faces in one plane; 1: turned", turned, stacks},
    {"neighbours", "two halves of one mesh, some units in the last place apart", digits,
     neighbours},
    {"exact contact", "cubes that touch in a point (0), along an edge (1), in a face (2)", contacts,
     exactly},
    {"grazing", "a ball slides over a cube at the right height; 1: turned", turned, grazing},
    {"rotations", "touching after a chain of multiplied rotations", chains, composed},
    {"tiny", "touching bodies of that size, down to denormal numbers", least, any_scale},
    {"mixed", "touching bodies, one so much larger, one so much smaller than 1", ratios, mixed},
};

bool share_a_point(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
  for (const auto& s : a)
    for (const auto& t : b)
      if (boxes_meet(s, t) && oracle::intersect(s, t)) return true;
  return false;
}

}  // namespace

std::span<const Stressor> stressors() { return list; }

std::vector<std::uint8_t> truth_of(const StressCase& stress) {
  std::vector<std::uint8_t> truth;
  std::vector<Pose> poses(2);
  for (std::size_t frame = 0; frame < stress.trace.frames; ++frame) {
    stress.trace.poses(frame, poses);
    truth.push_back(share_a_point(posed_triangles(stress.meshes[0], poses[0]),
                                  posed_triangles(stress.meshes[1], poses[1])));
  }
  return truth;
}

std::vector<Variant> stressed_variants() {
  std::vector<Variant> variants;
  const auto add = [&](const Variant& engine, const std::string& volume,
                       const std::string& strategy) {
    Precisions::for_each([&]<class P>(std::type_identity<P>) {
      Variant variant = engine;
      variant.volume = volume, variant.strategy = strategy;
      variant.precision = P::name;
      variants.push_back(std::move(variant));
    });
  };
  unsigned cell = 0;
  for (const auto& volume : volumes())
    for (const auto& strategy : strategies()) {
      add({}, volume.name, strategy.name);
      // Every fan-out and both frames, but each by some of the volumes and strategies alone.
      Variant wide;
      wide.fan_out = 4u << cell % 3;
      wide.frame = name_of(cell / 3 % 2 ? Frame::world : Frame::body);
      add(wide, volume.name, strategy.name);
      ++cell;
    }
  for (const char* kernel : {"siblings", "mixed"}) {
    Variant wide;
    set_kernel(wide, kernel);
    for (const auto& volume : wide_volumes(kernel))
      for (const char* strategy : {"recursive", "margins"}) add(wide, volume.name, strategy);
  }
  return variants;
}

}  // namespace bvlab
