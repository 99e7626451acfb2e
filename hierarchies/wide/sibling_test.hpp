// SPDX-License-Identifier: BSD-3-Clause
/// The sibling test: one volume of a body against siblings of another body, which are stored in
/// their mesh's frame. Its members:
///
///   FrameChange                 from one body's frame to the other's: once per pair of bodies
///   PosedNode, posed_node(...)  one volume, posed into the other's frame: one N_u
///   overlap(one, ..., sizes)    which lanes are disjoint from it, and an order of the rest: those
///                               likeliest to touch come first; `sizes` are the sums of the sizes
///                               of both volumes
///   gaps(one, ...)              a lower bound on its distance to each lane
///   separation(one, ...)        optional and cheaper: the same, negative where they may overlap
///   in_lanes(volumes, ...)      a volume of the first body in each lane, posed; in the three tests
///                               above it can stand for `one`
///
/// A volume V whose posed form is again a V gets the required members from `posed`
/// (PosedSiblingTest). A volume with a better test declares a `sibling_test` of its own.
#pragma once

#include <type_traits>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/relative_placement.hpp"
#include "hierarchies/wide/lanes.hpp"

namespace bvlab {

/// A volume that declares a sibling test of its own.
template <class V>
concept HasSiblingTest = requires { typename V::sibling_test; };

/// For each lane, whether it is disjoint, and its order: the least is tested first.
template <Scalar S>
struct OverlapLanes {
  Mask<S> apart;
  S order;
};

/// For each lane, a lower bound on its distance, and its order as in OverlapLanes.
template <Scalar S>
struct GapLanes {
  S gap, order;
};

namespace detail {

/// Approximately the centre of a volume.
template <class V>
auto centre_of_volume(const V& v) {
  using S = typename V::scalar;
  if constexpr (requires { v.centre; })
    return v.centre;
  else if constexpr (requires { v.box.centre; })
    return v.box.centre;
  else
    return Vec3<S>((v.bounds[0] - v.bounds[1]) * S(0.5f), (v.bounds[2] - v.bounds[3]) * S(0.5f),
                   (v.bounds[4] - v.bounds[5]) * S(0.5f));
}

/// The overlap test of posed volumes over S. The order is by the distance of the centres relative
/// to `sizes`, the sums of the volumes' sizes.
template <Scalar S, class P>
[[gnu::always_inline]] inline OverlapLanes<S> overlap_of_posed(const P& one, const P& lanes,
                                                               const S& sizes) {
  const Vec3<S> between = centre_of_volume(one) - centre_of_volume(lanes);
  return {disjoint(one, lanes), squared_norm<S>(between) * roughly_one_over<S>(sizes * sizes)};
}

}  // namespace detail

/// The test of posed volumes P in one frame: there is nothing to change.
template <class P>
struct PosedTest {
  using T = typename P::scalar;

  struct FrameChange {};
  struct PosedNode {
    P volume;
    T size;
  };
  static PosedNode posed_node(const P& volume, T size, const FrameChange&) {
    return {volume, size};
  }

  template <Batched S, class Change>
  [[gnu::always_inline]] static OverlapLanes<S> overlap(const PosedNode& one, const Change& change,
                                                        const Over<P, S>& lanes, const S& sizes) {
    return overlap<S>(in_all_lanes<S>(one.volume), change, lanes, sizes);
  }
  template <Batched S, class Change>
  [[gnu::always_inline]] static S gaps(const PosedNode& one, const Change&,
                                       const Over<P, S>& lanes) {
    return gap(in_all_lanes<S>(one.volume), lanes);
  }

  template <class Lanes>
  [[gnu::always_inline]] static const Lanes& in_lanes(const Lanes& volumes, const FrameChange&) {
    return volumes;
  }
  template <Batched S, class Change>
  [[gnu::always_inline]] static OverlapLanes<S> overlap(const Over<P, S>& one, const Change&,
                                                        const Over<P, S>& lanes, const S& sizes) {
    return detail::overlap_of_posed<S>(one, lanes, sizes);
  }
  template <Batched S, class Change>
  [[gnu::always_inline]] static S gaps(const Over<P, S>& one, const Change&,
                                       const Over<P, S>& lanes) {
    return gap(one, lanes);
  }
};

/// The default sibling test, for volumes V whose posed form is again a V.
template <class V>
struct PosedSiblingTest : PosedTest<V> {
  using typename PosedTest<V>::T, typename PosedTest<V>::PosedNode;
  static_assert(std::is_same_v<Posed<V>, V>, "this volume needs a sibling test of its own");

  using FrameChange = PlacementOf<V>;

  static FrameChange frame_change(const RelativePose& pose, double reach,
                                  double /*reach_of_lanes*/) {
    return relative_placement<V>(pose, reach);
  }
  static PosedNode posed_node(const V& volume, T size, const FrameChange& frame_change) {
    return {posed(volume, frame_change), size};
  }
  template <class Lanes>
  [[gnu::always_inline]] static Lanes in_lanes(const Lanes& volumes,
                                               const FrameChange& frame_change) {
    return posed(volumes, frame_change);
  }
};

namespace detail {
template <class V>
struct SiblingTestOf {
  using type = PosedSiblingTest<V>;
};
template <HasSiblingTest V>
struct SiblingTestOf<V> {
  using type = typename V::sibling_test;
};
}  // namespace detail

template <class V>
using SiblingTestOf = typename detail::SiblingTestOf<V>::type;

/// The separation of a volume, or of one in each lane, from lanes; `sizes` are the sums of the
/// volumes' sizes. Where the test has none, gaps and the order of overlaps.
template <class SiblingTest, Batched S, class One, class FrameChange, class Lanes>
[[gnu::always_inline]] inline GapLanes<S> separation_of(const One& one,
                                                        const FrameChange& frame_change,
                                                        const Lanes& lanes, const S& sizes) {
  if constexpr (requires { SiblingTest::template separation<S>(one, frame_change, lanes); }) {
    const S gap = SiblingTest::template separation<S>(one, frame_change, lanes);
    return {gap, gap * roughly_one_over<S>(sizes)};
  } else {
    return {SiblingTest::template gaps<S>(one, frame_change, lanes),
            SiblingTest::template overlap<S>(one, frame_change, lanes, sizes).order};
  }
}

}  // namespace bvlab
