// SPDX-License-Identifier: BSD-3-Clause
/// The algorithm of Gilbert, Johnson and Keerthi (gilbert1988fast): a simplex of the difference of
/// two convex bodies moves towards the origin, a support vertex at a time. `Support::scan` looks at
/// all vertices each time; `Support::climb` is Cameron's enhancement (cameron1997enhancing): it
/// climbs along edges from the last support vertex, and starts from the last question's simplex,
/// which makes coherent questions cost nearly the same whatever the number of vertices.
#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "experiments/closest_features/witness.hpp"

namespace bvlab::closest_features {

enum class Support { scan, climb };

template <Support how>
class Gjk {
 public:
  Witness nearest(const PosedPair& posed, Effort& effort);

 private:
  /// A vertex of the difference a - b, in a's frame.
  struct Corner {
    std::uint32_t a, b;
    Vec3<double> at;
  };
  struct Simplex {
    std::array<Corner, 4> corners;
    std::size_t size = 0;
    Vec3<double> nearest;  ///< its point nearest to the origin
    void add(const Corner& corner) { corners[size++] = corner; }
  };

  Corner corner(const PosedPair& posed, std::uint32_t a, std::uint32_t b) const {
    return {a, b, posed.a->vertices()[a] - posed.b_in_a(posed.b->vertices()[b])};
  }
  static std::uint32_t farthest(const Polytope& polytope, const Vec3<double>& direction,
                                std::uint32_t start, Effort& effort);
  static Simplex reduced(const Simplex& simplex);
  static Simplex of_triangle(const Corner& a, const Corner& b, const Corner& c);
  static Simplex of_segment(const Corner& a, const Corner& b);
  Witness witness(bool apart) const;

  Simplex simplex_;  ///< of the last question
};

template <Support how>
std::uint32_t Gjk<how>::farthest(const Polytope& polytope, const Vec3<double>& direction,
                                 std::uint32_t start, Effort& effort) {
  const auto& vertices = polytope.vertices();
  if constexpr (how == Support::scan) {
    std::uint32_t best = 0;
    double most = vertices[0].dot(direction);
    for (std::uint32_t v = 1; v < vertices.size(); ++v)
      if (const double d = vertices[v].dot(direction); d > most) most = d, best = v;
    effort.vertices += vertices.size();
    return best;
  } else {
    // A vertex with no higher neighbour is highest: that is what convex means.
    double most = vertices[start].dot(direction);
    for (std::uint32_t best = start;; start = best) {
      for (const auto edge : polytope.edges_at(start)) {
        const std::uint32_t v = polytope.other_end(edge, start);
        if (const double d = vertices[v].dot(direction); d > most) most = d, best = v;
        ++effort.vertices;
      }
      if (best == start) return start;
    }
  }
}

template <Support how>
auto Gjk<how>::of_segment(const Corner& a, const Corner& b) -> Simplex {
  const Vec3<double> ab = b.at - a.at;
  const double along = -a.at.dot(ab), squared = ab.squaredNorm();
  Simplex result;
  if (along <= 0 || squared == 0) {
    result.add(a), result.nearest = a.at;
  } else if (along >= squared) {
    result.add(b), result.nearest = b.at;
  } else {
    result.add(a), result.add(b), result.nearest = a.at + along / squared * ab;
  }
  return result;
}

template <Support how>
auto Gjk<how>::of_triangle(const Corner& a, const Corner& b, const Corner& c) -> Simplex {
  const Vec3<double> normal = (b.at - a.at).cross(c.at - a.at);
  const double squared = normal.squaredNorm();
  const auto inside = [&](const Corner& p, const Corner& q) {
    return normal.cross(q.at - p.at).dot(-p.at) > 0;
  };
  if (squared > 0 && inside(a, b) && inside(b, c) && inside(c, a)) {
    Simplex result;
    result.add(a), result.add(b), result.add(c);
    result.nearest = a.at.dot(normal) / squared * normal;
    return result;
  }
  Simplex best = of_segment(a, b);
  for (const Simplex& other : {of_segment(b, c), of_segment(c, a)})
    if (other.nearest.squaredNorm() < best.nearest.squaredNorm()) best = other;
  return best;
}

/// The smallest face of the simplex that holds its point nearest to the origin; a simplex of four
/// holds the origin itself.
template <Support how>
auto Gjk<how>::reduced(const Simplex& simplex) -> Simplex {
  const auto& c = simplex.corners;
  if (simplex.size == 1) {
    Simplex result = simplex;
    result.nearest = c[0].at;
    return result;
  }
  if (simplex.size == 2) return of_segment(c[0], c[1]);
  if (simplex.size == 3) return of_triangle(c[0], c[1], c[2]);
  Simplex best = simplex;
  best.nearest = Vec3<double>::Zero();
  bool outside = false;
  for (const auto& [i, j, k, l] :
       {std::array<std::size_t, 4>{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}}) {
    const Vec3<double> normal = (c[j].at - c[i].at).cross(c[k].at - c[i].at);
    const double mine = -normal.dot(c[i].at), others = normal.dot(c[l].at - c[i].at);
    if (mine * others > 0) continue;  // on the same side as the fourth corner
    const Simplex face = of_triangle(c[i], c[j], c[k]);
    if (!outside || face.nearest.squaredNorm() < best.nearest.squaredNorm()) best = face;
    outside = true;
  }
  return best;
}

template <Support how>
Witness Gjk<how>::witness(bool apart) const {
  Witness result;
  result.apart = apart;
  for (std::size_t k = 0; k < std::min<std::size_t>(simplex_.size, 3); ++k) {
    result.corners[0].add(simplex_.corners[k].a);
    result.corners[1].add(simplex_.corners[k].b);
  }
  return result;
}

template <Support how>
Witness Gjk<how>::nearest(const PosedPair& posed, Effort& effort) {
  Simplex start;
  if (how == Support::climb && simplex_.size > 0)
    for (std::size_t k = 0; k < simplex_.size; ++k)
      start.add(corner(posed, simplex_.corners[k].a, simplex_.corners[k].b));
  else
    start.add(corner(posed, 0, 0));
  simplex_ = reduced(start);
  const double size = start.corners[0].at.norm() + posed.translation.norm();
  // Every step brings the simplex nearer, or is the last: there is a next one only as long as
  // rounding does not hide it.
  for (double before = std::numeric_limits<double>::infinity();;) {
    ++effort.steps;
    const Vec3<double> v = simplex_.nearest;
    const double squared = v.squaredNorm();
    // A point counts as the origin where rounding cannot distinguish the two.
    const double blur = 16 * unit_roundoff<double> * size;
    if (simplex_.size == 4 || squared <= blur * blur) return witness(false);
    if (!(squared < before)) return witness(true);
    before = squared;
    const auto& last = simplex_.corners[simplex_.size - 1];
    const Corner next = corner(posed, farthest(*posed.a, -v, last.a, effort),
                               farthest(*posed.b, posed.rotation.transpose() * v, last.b, effort));
    // v is nearest unless the support plane leaves room: 1e-14 of what is squared here is far
    // below 1e-12 of the distance.
    if (squared - v.dot(next.at) <= 1e-14 * squared) return witness(true);
    Simplex grown = simplex_;
    grown.add(next);
    const Simplex smaller = reduced(grown);
    if (!(smaller.nearest.squaredNorm() < squared)) return witness(true);
    simplex_ = smaller;
  }
}

}  // namespace bvlab::closest_features
