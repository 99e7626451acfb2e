// SPDX-License-Identifier: BSD-3-Clause
/// How one volume of a body is compared with siblings of another, which lie as their mesh does.
///
///   FrameChange            what takes one body's frame to the other's: once a pair of bodies
///   One                    one volume seen from there: one N_u
///   compared(one, ...)     which lanes it is apart from, and in which order the rest are worth
///                          looking at, the likeliest to touch first
///   gaps(one, ...)         how far it is from each lane, at least
///
/// Any volume whose posed form is of its own kind has all that by being posed. One that can do
/// better declares a `facing` of its own.
#pragma once

#include <type_traits>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/geometry/relative_pose.hpp"
#include "hierarchies/wide/lanes.hpp"

namespace bvlab {

template <Scalar S>
struct Compared {
  Mask<S> apart;
  S order;
};

/// The same, with how far they are apart instead of whether they are.
template <Scalar S>
struct Separated {
  S gap, order;
};

namespace detail {

/// About the middle of a volume.
template <class V>
auto middle_of_volume(const V& v) {
  using S = typename V::scalar;
  if constexpr (requires { v.centre; })
    return v.centre;
  else if constexpr (requires { v.box.centre; })
    return v.box.centre;
  else
    return Vec3<S>((v.bounds[0] - v.bounds[1]) * S(0.5f), (v.bounds[2] - v.bounds[3]) * S(0.5f),
                   (v.bounds[4] - v.bounds[5]) * S(0.5f));
}

/// By their posed forms, both volumes over S. The order is that of the distance of the middles over
/// both sizes.
template <Scalar S, class P>
[[gnu::always_inline]] inline Compared<S> compared_posed(const P& one, const P& lanes,
                                                         const S& size, const S& sizes) {
  const Vec3<S> between = middle_of_volume(one) - middle_of_volume(lanes);
  const S room = size + sizes;
  return {disjoint(one, lanes), squared_norm<S>(between) * roughly_one_over<S>(room * room)};
}

}  // namespace detail

/// By posing.
template <class V>
struct PosedFacing {
  using T = typename V::scalar;
  static_assert(std::is_same_v<Posed<V>, V>, "this volume needs a facing of its own");

  using FrameChange = PlacementOf<V>;
  struct One {
    V volume;
    T size;
  };

  static FrameChange frame_change(const RelativePose& pose, double reach,
                                  double /*reach_of_lanes*/) {
    if constexpr (std::is_same_v<FrameChange, Placement<T>>)
      return FrameChange(typename FrameChange::Orthonormal{}, pose.rotation(), pose.shift(), reach,
                         pose.noise);
    else
      return FrameChange(Pose{pose.rotation(), pose.shift()}, Vec3<double>::Zero(), reach,
                         pose.noise);
  }
  static One one(const V& volume, T size, const FrameChange& frame_change) {
    return {posed(volume, frame_change), size};
  }

  template <Batched S>
  [[gnu::always_inline]] static Compared<S> compared(const One& one, const FrameChange&,
                                                     const Over<V, S>& lanes, const S& sizes) {
    return detail::compared_posed<S>(in_all_lanes<S>(one.volume), lanes, S(one.size), sizes);
  }
  template <Batched S>
  [[gnu::always_inline]] static S gaps(const One& one, const FrameChange&,
                                       const Over<V, S>& lanes) {
    return gap(in_all_lanes<S>(one.volume), lanes);
  }
};

namespace detail {
template <class V>
struct FacingOf {
  using type = PosedFacing<V>;
};
template <class V>
requires requires { typename V::facing; }
struct FacingOf<V> {
  using type = typename V::facing;
};
}  // namespace detail

template <class V>
using FacingOf = typename detail::FacingOf<V>::type;

}  // namespace bvlab
