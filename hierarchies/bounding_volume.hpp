// SPDX-License-Identifier: BSD-3-Clause
/// The concept of a bounding volume, the laws that every volume keeps, and its optional members.
#pragma once

#include <concepts>
#include <span>
#include <string_view>
#include <utility>

#include "hierarchies/geometry/placement.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The volume V over another scalar: `Over<Sphere<float>, Batch<float, 8>>` is eight spheres.
template <class V, class S>
using Over = typename V::template over<S>;

namespace detail {
// Empty for what is no volume, so that BoundingVolume is false of it, and no error.
template <class V>
struct PlacementOf {};
template <class V>
  requires(
      requires { typename V::scalar; } && !requires { typename V::placement; })
struct PlacementOf<V> {
  using type = Placement<Element<typename V::scalar>>;
};
template <class V>
  requires requires { typename V::placement; }
struct PlacementOf<V> {
  using type = typename V::placement;
};
}  // namespace detail

/// The pose type that `posed` takes for V. A volume for which `Placement` is not enough declares a
/// type `placement` of its own with the same constructor, which is called at most once per move.
template <class V>
using PlacementOf = typename detail::PlacementOf<V>::type;

/// The type of a posed V: the form in which volumes are tested against each other.
template <class V>
using Posed = decltype(posed(std::declval<const V&>(), std::declval<const PlacementOf<V>&>()));

/// A volume that can be fitted to the surface, not only to points. `points` contains all corners of
/// the triangles.
template <class V>
concept FittedToTriangles =
    requires(std::span<const Vec3<double>> points, std::span<const Triangle> triangles) {
      { V::enclosing(points, triangles) } -> std::same_as<V>;
    };

/// A volume with a second construction, which is slower and gives a tighter volume.
template <class V>
concept FittedTightly =
    requires(std::span<const Vec3<double>> points, std::span<const Triangle> triangles) {
      { V::tight(points, triangles) } -> std::same_as<V>;
    };

/// Which construction fits volumes: the published one, or the tighter one where the volume has
/// one.
enum class Fit { published, tight };

constexpr std::string_view name_of(Fit fit) { return fit == Fit::tight ? "tight" : "published"; }

/// A solid that encloses points and can be tested cheaply against its own kind.
///
/// A volume is a plain aggregate of scalars S (float, double, or a SIMD batch of either), with free
/// functions found by argument-dependent lookup. Laws, checked by tests/laws for every entry of
/// `Volumes`:
///   enclosure     `contains` is true for every point given to `enclosing`, and stays true after
///                 `merge` and `posed`, rounding included: posed volumes hold posed vertices;
///   conservatism  if a point lies in both, `disjoint` is false, even where numbers overflow;
///   gap           `gap` never exceeds the true distance, and is 0 where a point lies in both;
///   batches       each lane of a batch gives what the scalar gives.
template <class V>
concept BoundingVolume =
    requires(const V a, const V b, std::span<const Vec3<double>> points,
             const PlacementOf<V> placement, const Posed<V> p, const Posed<V> q) {
      { V::name } -> std::convertible_to<std::string_view>;
      { V::description } -> std::convertible_to<std::string_view>;
      { V::enclosing(points) } -> std::same_as<V>;  // one point or more
      { merge(a, b) } -> std::same_as<V>;
      { posed(a, placement) };                   // one N_u
      { disjoint(p, q) } -> std::same_as<bool>;  // one N_v; a mask where S is a batch
      { gap(p, q) } -> std::same_as<typename V::scalar>;
      { contains(p, Vec3<long double>{}) } -> std::same_as<bool>;  // for tests: slow and careful
      { size(a) } -> std::same_as<typename V::scalar>;             // the larger one is descended
      {
        reach(a)
      } -> std::same_as<typename V::scalar>;  // how far from the frame's origin it extends
    };

/// `size(volume)` and `reach(volume)`, for scopes in which a member of the same name hides them.
template <BoundingVolume V>
typename V::scalar size_of(const V& volume) {
  return size(volume);
}
template <BoundingVolume V>
typename V::scalar reach_of(const V& volume) {
  return reach(volume);
}

}  // namespace bvlab
