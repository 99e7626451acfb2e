// SPDX-License-Identifier: BSD-3-Clause
/// A box along the axes of the mesh's own frame, cut by a slab whose normal is that of the surface.
/// Small patches of surface are flat: the slab makes the box thin, as in slab-cut balls
/// (larsson2009slabcut), at a third of the cost of an oriented box's nine edge axes.
///
/// Meant for tests in a relative frame (wide/sibling_test.hpp). Posed into the world it is an
/// oriented box with a slab, and costs as much. The slab is the set of points x with |n.(x -
/// centre) - slab_centre| <= width, for the normal n exactly as stored.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/volumes/slab_box_columns.hpp"

namespace bvlab {

template <class S>
struct SlabBoxSiblingTest;

template <Scalar S>
struct SlabBox {
  static constexpr std::string_view name = "slab-box";
  static constexpr std::string_view description =
      "box in the mesh's own frame, cut by a slab across the surface's normal";
  using scalar = S;
  template <class Other>
  using over = SlabBox<Other>;
  /// Its test in a relative frame; include wide/slab_box_sibling_test.hpp to use it.
  using sibling_test = SlabBoxSiblingTest<S>;
  /// Fits volumes to ranges of triangles that lie in columns.
  using columns = SlabBoxColumns<SlabBox>;

  Vec3<S> centre, half, normal;
  S slab_centre, width;

  static SlabBox enclosing(std::span<const Vec3<double>> points)
    requires(!Batched<S>)
  {
    SlabBox box = box_around(points);
    Mat3<double> spread = Mat3<double>::Zero();
    for (const auto& p : points) {
      const Vec3<double> x = p - box.centre.template cast<double>();
      spread += x * x.transpose();
    }
    box.cut(Eigen::SelfAdjointEigenSolver<Mat3<double>>(spread).eigenvectors().col(0), points);
    return box;
  }

  /// The slab is the thinner of two: across the mean normal, or across the direction that the
  /// surface faces most; for a single triangle they coincide.
  static SlabBox enclosing(std::span<const Vec3<double>> points,
                           std::span<const Triangle> triangles)
    requires(!Batched<S>)
  {
    SlabBox box = box_around(points);
    Vec3<double> mean = Vec3<double>::Zero();
    Mat3<double> facing = Mat3<double>::Zero();
    for (const auto& t : triangles) {
      const Vec3<double> normal = (t[1] - t[0]).cross(t[2] - t[0]);
      const double area = std::sqrt(squared_norm(normal));
      mean += normal;
      if (area > 0) facing += normal * normal.transpose() / area;
    }
    const double length = std::sqrt(squared_norm(mean));
    if (triangles.size() == 1 && length > 0) {
      box.cut(mean / length, points);
      return box;
    }
    box.cut(Eigen::SelfAdjointEigenSolver<Mat3<double>>(facing).eigenvectors().col(2), points);
    if (length > 0) {
      SlabBox other = box;
      other.cut(mean / length, points);
      if (other.width < box.width) return other;
    }
    return box;
  }

 private:
  friend SlabBoxColumns<SlabBox>;

  /// The box without its slab.
  static SlabBox box_around(std::span<const Vec3<double>> points) {
    Vec3<double> low = points[0], high = low;
    for (const auto& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return between(low, high);
  }
  /// A difference of two coordinates has one rounding.
  static SlabBox between(const Vec3<double>& low, const Vec3<double>& high) {
    SlabBox box;
    box.centre = rounded<S>(low / 2 + high / 2);
    for (int i = 0; i < 3; ++i) {
      const double centre = box.centre[i];
      box.half[i] = rounded_up<S>(std::max(high[i] - centre, centre - low[i]) *
                                  (1 + 2 * unit_roundoff<double>));
    }
    return box;
  }

  /// Sets the slab across `direction`.
  void cut(const Vec3<double>& direction, std::span<const Vec3<double>> points) {
    face(direction);
    const Vec3<double> n = normal.template cast<double>(), c = centre.template cast<double>();
    double low = std::numeric_limits<double>::infinity(), high = -low, farthest = 0;
    for (const auto& p : points) {
      const Vec3<double> x = p - c;
      const double at = dot<double>(n, x);
      low = std::min(low, at), high = std::max(high, at);
      farthest = std::max(farthest, (std::abs(x[0]) + std::abs(x[1])) + std::abs(x[2]));
    }
    bound(low, high, farthest);
  }
  /// Sets the normal to `direction`; to the x axis if that is no unit vector, as where the length
  /// that a normal was divided by had underflowed. A longer normal would make gaps too large.
  void face(const Vec3<double>& direction) {
    const double squared = squared_norm(direction);
    normal =
        rounded<S>(squared > 0.5 && squared < longest_normal ? direction
                                                             : Vec3<double>(Vec3<double>::UnitX()));
  }
  static constexpr double longest_normal = 1 + 0x1p-30;  // squared
  /// Sets the slab around all n.x from `low` to `high`, for the normal n and points x about the
  /// centre, |x|_1 being at most `farthest`. Sums of three products of differences are off by less
  /// than 8u of their magnitudes, which are at most |x|_1 for a normal of about unit length.
  void bound(double low, double high, double farthest) {
    slab_centre = static_cast<S>(low / 2 + high / 2);
    const double tiny = std::ldexp(1.0, std::numeric_limits<double>::min_exponent / 2);
    width = rounded_up<S>(std::max(high - double(slab_centre), double(slab_centre) - low) +
                          16 * unit_roundoff<double> * farthest + tiny);
  }
};

/// A slab-box posed into the world.
template <Scalar S>
struct PosedSlabBox {
  using scalar = S;
  template <class Other>
  using over = PosedSlabBox<Other>;
  Obb<S> box;
  Vec3<S> normal;
  S slab_centre, width;
};

/// The box around the corners of both, with the slab across the direction in which the corners
/// spread least. Looser than a volume fitted to triangles.
template <class S>
SlabBox<S> merge(const SlabBox<S>& a, const SlabBox<S>& b) {
  std::array<Vec3<double>, 16> corners;
  for (std::size_t i = 0; i < 16; ++i) {
    const SlabBox<S>& box = i < 8 ? a : b;
    for (int k = 0; k < 3; ++k) {
      // One rounding; the half length covers it.
      const double half = double(box.half[k]) + 2 * unit_roundoff<double> * std::abs(box.centre[k]);
      corners[i][k] = double(box.centre[k]) + (i >> k & 1 ? half : -half);
    }
  }
  return SlabBox<S>::enclosing(corners);
}

/// A point centre + y of the slab goes to within slack of the posed centre plus Qy, and its normal
/// to within tilt of Qn (see Placement): |n'.(x' - centre') - slab_centre| grows by at most tilt
/// |y| + slack |n'|. Five more roundings are made here.
template <class S>
PosedSlabBox<S> posed(const SlabBox<S>& volume, const Placement<Element<S>>& placement) {
  const S one(1), zero(0);
  const Obb<S> box{
      volume.centre, {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}}, volume.half};
  constexpr Element<S> e = unit_roundoff<S>;
  const S blur =
      S(placement.slack) + S(placement.tilt) * ((volume.half[0] + volume.half[1]) + volume.half[2]);
  return {posed(box, placement), placement.directed(volume.normal), volume.slab_centre,
          (volume.width + blur * S(1 + 16 * e)) * S(1 + 8 * e)};
}

namespace detail {

/// Whether all of b's box is on one side of a's slab.
///
/// n.t and n.b_k are off by less than 8e of |t| and 1; what they are summed with adds as much of
/// itself. The margin of ObbPair is more than that: 256e of |t| and all half lengths, and
/// `slab_centre` is not farther out than the box.
template <class S>
Mask<S> apart_by_slab(const PosedSlabBox<S>& a, const PosedSlabBox<S>& b, const S& margin) {
  using std::abs;
  const Vec3<S> t = b.box.centre - a.box.centre;
  S reached = a.width + margin;
  for (int k = 0; k < 3; ++k)
    reached = reached + b.box.half[k] * abs(dot<S>(a.normal, b.box.axes[k]));
  return abs(dot<S>(a.normal, t) - a.slab_centre) > reached;
}

}  // namespace detail

/// A comparison with NaN (from an overflow) means not disjoint.
template <class S>
Mask<S> disjoint(const PosedSlabBox<S>& a, const PosedSlabBox<S>& b) {
  const S margin = detail::ObbPair<S>(a.box, b.box).margin;
  return disjoint(a.box, b.box) || detail::apart_by_slab<S>(a, b, margin) ||
         detail::apart_by_slab<S>(b, a, margin);
}

template <class S>
S gap(const PosedSlabBox<S>& a, const PosedSlabBox<S>& b) {
  return gap(a.box, b.box);
}

template <class S>
bool contains(const PosedSlabBox<S>& volume, const Vec3<long double>& point) {
  using Wide = Vec3<long double>;
  const Wide x = point - volume.box.centre.template cast<long double>();
  const long double at = volume.normal.template cast<long double>().dot(x);
  return contains(volume.box, point) &&
         !(std::abs(at - static_cast<long double>(volume.slab_centre)) >
           static_cast<long double>(volume.width));
}
template <class S>
bool contains(const SlabBox<S>& volume, const Vec3<long double>& point) {
  return contains(posed(volume, Placement<S>()), point);
}

/// Half the diagonal. Of numbers or batches, in the order of Eigen's norm of three floats.
template <class S>
S size(const SlabBox<S>& volume) {
  using std::sqrt;
  const Vec3<S>& h = volume.half;
  return sqrt(h[0] * h[0] + (h[1] * h[1] + h[2] * h[2]));
}

template <class S>
S reach(const SlabBox<S>& volume) {
  using std::sqrt;
  const Vec3<S>& c = volume.centre;
  return sqrt(c[0] * c[0] + (c[1] * c[1] + c[2] * c[2])) +
         size(volume) * S(1 + 8 * unit_roundoff<S>);
}

}  // namespace bvlab
