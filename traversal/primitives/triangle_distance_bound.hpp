// SPDX-License-Identifier: BSD-3-Clause
/// A lower bound on the distance of two closed triangles, for W pairs at a time, nearly tight where
/// they are apart. It rules out most candidates for the nearest pair, and only the others need
/// `distance`. Cost: about a tenth of one `distance`.
///
/// The bound is the least over the same 33 candidates as in triangle_distance.hpp, in float64, each
/// lowered by its possible rounding error; it is 0 unless the first stage is certain that the
/// triangles are apart. Squares are compared, with u the unit roundoff:
/// - a vector r = w - s e - t f is off by 3 u R, R = |w| + 2 |s e| + 2 |t f| >= |r|, so its square
///   by less than 8 u R^2;
/// - s of a point on an edge is off by less than 14 u M / |e|, M the longest w, so that a point put
///   at an end may be inside: its square is too large by less than 2^-98 M^2;
/// - s of two crossing directions, by cross products, is off by less than 32 u M / (|e| sin^2), M =
///   |w| + |e| + |f|, and t, made from s, by as much times |e| / |f| (each minor is off by 4 u of
///   its factors' lengths, three of them in a product divided by |e|^2 |f|^2 sin^2). A candidate is
///   taken unless it is farther outside than that: outside it is the distance of lines and planes,
///   which is smaller. What s leaves in r is orthogonal to f, 32 u M / sin, and raises the square
///   by at most 2^-96 M^2 / sin^2;
/// - directions at an angle with sin^2 < 2^-40 are not crossed. If the nearest points are inside,
///   both can be moved along until one is at an end (or, in a sliver, to an edge): r is orthogonal
///   to the way, and the square of the distance grows by at most min(|e|, |f|)^2 sin^2. The sine as
///   computed is off by less than 8 u.
/// The latter two may add up for one candidate: the larger is taken twice.
/// Range: no number is above 2^100, so that products of six differences are finite. Edges may be
/// arbitrarily short, and products of their squares underflow: where |e|^2 |f|^2 is below 2^-800
/// the two are not crossed either, and to leave that out raises the square of the distance by less
/// than min(|e|, |f|)^2 < 2^-399. Else |n|^2 is above 2^-840 where it counts. A point on an edge
/// whose square underflows lies anywhere between its ends, which adds less than 2^-399, too, or is
/// covered by the rounding of w.
#pragma once

#include <cmath>
#include <limits>

#include "traversal/primitives/triangle_filter.hpp"

namespace bvlab {

namespace filter {

template <Scalar S>
class DistanceBound {
  static constexpr double u = unit_roundoff<double>;

 public:
  [[gnu::always_inline]] DistanceBound(const Corners<S>& a, const Corners<S>& b)
      : square_(std::numeric_limits<double>::infinity()) {
    const Edges edges_a(a), edges_b(b);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) w_[i][j] = a[i] - b[j], w_size_[i][j] = size_of(w_[i][j]);
    // `longest`: at least as long as any w.
    const S longest =
        w_size_[0][0] + ((edges_a.size[0] + edges_a.size[2]) + (edges_b.size[0] + edges_b.size[2]));
    skipped_ = S(0x1p-97) * (longest * longest) + S(0x1p-398);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int next = j == 2 ? 0 : j + 1;
        corner_edge(w_[i][j], w_size_[i][j], w_[i][next], w_size_[i][next], edges_b, j, S(1));
        corner_edge(w_[j][i], w_size_[j][i], w_[next][i], w_size_[next][i], edges_a, j, S(-1));
      }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        crossing<Inside::edges>(negative(w_[i][j]), w_size_[i][j], edges_a.vector[i],
                                edges_a.square[i], edges_a.over_square[i], edges_a.size[i],
                                negative(edges_b.vector[j]), edges_b.square[j],
                                edges_b.over_square[j], edges_b.size[j]);
    for (int i = 0; i < 3; ++i) {
      // The face's directions from its first corner: its first edge, and its last one reversed.
      crossing<Inside::face>(w_[i][0], w_size_[i][0], edges_b.vector[0], edges_b.square[0],
                             edges_b.over_square[0], edges_b.size[0], negative(edges_b.vector[2]),
                             edges_b.square[2], edges_b.over_square[2], edges_b.size[2]);
      crossing<Inside::face>(negative(w_[0][i]), w_size_[0][i], edges_a.vector[0],
                             edges_a.square[0], edges_a.over_square[0], edges_a.size[0],
                             negative(edges_a.vector[2]), edges_a.square[2], edges_a.over_square[2],
                             edges_a.size[2]);
    }
  }

  S lower() const {
    const S square = max(square_ - skipped_, S(0));
    constexpr double below = 1 - 8 * u;
    if constexpr (Batched<S>)
      return S([&](auto lane) { return std::sqrt(square[lane]) * below; });
    else
      return std::sqrt(square) * below;
  }

 private:
  enum class Inside { edges, face };

  static S size_of(const Vector<S>& v) { return abs(v[0]) + abs(v[1]) + abs(v[2]); }
  static Vector<S> negative(const Vector<S>& v) { return {-v[0], -v[1], -v[2]}; }

  struct Edges {
    Vector<S> vector[3];
    S square[3], over_square[3], size[3];

    [[gnu::always_inline]] explicit Edges(const Corners<S>& t) {
      for (int j = 0; j < 3; ++j) {
        vector[j] = t[j == 2 ? 0 : j + 1] - t[j];
        square[j] = dot<S>(vector[j], vector[j]);
        over_square[j] = S(1) / square[j];
        size[j] = size_of(vector[j]);
      }
    }
  };

  [[gnu::always_inline]] void offer(const S& square, const S& rounding) {
    square_ = min(square_, square - S(8 * u) * (rounding * rounding));
  }

  /// Offers the distance of a corner and edge j. `w` points from the edge's first corner to the
  /// corner (times `way`), `at_end` from its last.
  [[gnu::always_inline]] void corner_edge(const Vector<S>& w, const S& size,
                                          const Vector<S>& at_end, const S& size_at_end,
                                          const Edges& edges, int j, const S& way) {
    const Vector<S>& e = edges.vector[j];
    const S s = way * dot<S>(w, e) * edges.over_square[j];
    const S step = way * s;
    const Vector<S> r = {w[0] - step * e[0], w[1] - step * e[1], w[2] - step * e[2]};
    // Written so that an edge of length zero counts as its first corner.
    const Mask<S> inner = s > S(0), behind = s >= S(1);
    const S inner_size = size + 2 * abs(s) * edges.size[j];
    const S square =
        select<S>(behind, dot<S>(at_end, at_end), select<S>(inner, dot<S>(r, r), dot<S>(w, w)));
    offer(square, select<S>(behind, size_at_end, select<S>(inner, inner_size, size)));
  }

  /// Offers the least |w - s e - t f|, if its s and t are inside, or nearly so.
  template <Inside kInside>
  [[gnu::always_inline]] void crossing(const Vector<S>& w, const S& w_size, const Vector<S>& e,
                                       const S& e_square, const S& over_e_square, const S& e_size,
                                       const Vector<S>& f, const S& f_square,
                                       const S& over_f_square, const S& f_size) {
    const Vector<S> n = cross<S>(e, f);
    const S square = dot<S>(n, n), product = e_square * f_square;
    const S over_square = S(1) / square;
    const Mask<S> normal = product > S(0x1p-800);
    const Mask<S> wide = normal && square >= 0x1p-40 * product;
    const S s = dot<S>(cross<S>(w, f), n) * over_square;
    const Vector<S> rest = {w[0] - s * e[0], w[1] - s * e[1], w[2] - s * e[2]};
    const S t = dot<S>(rest, f) * over_f_square;
    const Vector<S> r = {rest[0] - t * f[0], rest[1] - t * f[1], rest[2] - t * f[2]};
    const S depth = kInside == Inside::edges ? min(min(s, t), min(S(1) - s, S(1) - t))
                                             : min(min(s, t), S(1) - s - t);
    const S over_sine = product * over_square, m = w_size + e_size + f_size;
    // |e| is at least its size / sqrt(3).
    const Mask<S> inside = depth * min(e_size, f_size) > S(-128 * u) * (over_sine * m);
    const S rounding = w_size + 2 * (abs(s) * e_size + abs(t) * f_size);
    const S lowered =
        dot<S>(r, r) - (S(8 * u) * (rounding * rounding) + S(0x1p-96) * (over_sine * (m * m)));
    square_ = min(square_, select<S>(wide && inside, lowered, square_));
    // Twice min(|e|, |f|)^2 (2 sin^2 + 2^-98), without a division.
    const S narrow =
        4 * (square * min(over_e_square, over_f_square)) + S(0x1p-97) * min(e_square, f_square);
    skipped_ = max(skipped_, select<S>(normal && !wide, narrow, S(0)));
  }

  Vector<S> w_[3][3];
  S w_size_[3][3];
  S square_, skipped_;
};

}  // namespace filter

/// A lower bound on the distance of each pair; 0 where rounding leaves open whether they touch.
template <Scalar S>
S distance_bound(const Corners<S>& a, const Corners<S>& b) {
  using namespace filter;
  S largest(0);
  for (const Corners<S>* t : {&a, &b})
    for (const auto& p : *t) largest = max(largest, max(max(abs(p[0]), abs(p[1])), abs(p[2])));
  const Mask<S> safe = largest < S(0x1p100) && largest > S(0x1p-100);
  const Mask<S> apart = certainly<S>(a, b).apart && safe;
  return select<S>(apart, DistanceBound<S>(a, b).lower(), S(0));
}

}  // namespace bvlab
