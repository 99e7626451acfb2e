// SPDX-License-Identifier: BSD-3-Clause
/// The tests of the volumes of two bodies as a traversal by the gathered kernel calls them: through
/// a pointer, so that it is compiled once for all volumes. In the world frame volumes are read as
/// they were posed; else, and where a body is too far from the origin for float (is_far), that of a
/// is posed into the frame of b in each test.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hierarchies/relative_placement.hpp"
#include "traversal/body.hpp"
#include "traversal/gather.hpp"
#include "traversal/measured_gaps.hpp"
#include "traversal/queries/query.hpp"
#include "traversal/workspace.hpp"

namespace bvlab {

/// Of two bodies under one query.
template <class Query>
struct VolumeTests {
  /// Which pairs of nodes the query culls, as bits. Writes lower bounds on the distances of the
  /// volumes to `gaps`, if these are measured.
  using Culled = std::uint64_t (*)(const VolumeTests&, const std::uint32_t* nodes_a,
                                   const std::uint32_t* nodes_b, Query&, float* gaps);
  /// Of one pair, of four, or of as many as there are lanes.
  struct OfWidths {
    Culled one, four, all;
  };
  const OfWidths *culled, *culled_with_gaps;
  const void *volumes_a, *volumes_b;
  const void* placement;  ///< of a in the frame of b; null in the world frame
};

namespace detail {

template <class T, int W>
struct LanesOrOne {
  using type = Batch<T, W>;
};
template <class T>
struct LanesOrOne<T, 1> {
  using type = T;
};
/// The scalar, or a batch of more lanes than one.
template <class T, int W>
using OfWidth = typename LanesOrOne<T, W>::type;

template <bool kGaps, class P, class Query>
[[gnu::always_inline]] inline std::uint64_t culled(const P& p, const P& q, Query& query,
                                                   [[maybe_unused]] float* gaps) {
  if constexpr (kGaps) {
    const auto apart = gap(p, q);
    using S = std::remove_const_t<decltype(apart)>;
    if constexpr (std::is_same_v<S, float>) {
      gaps[0] = apart;
    } else if constexpr (Batched<S>) {
      if constexpr (std::is_same_v<Element<S>, float>)
        apart.copy_to(gaps, stdx::element_aligned);
      else
        for (std::size_t k = 0; k < S::size(); ++k) gaps[k] = just_below(apart[k]);
    } else {
      gaps[0] = just_below(apart);
    }
    if constexpr (wants_bound<Query>()) return bits(query.culls(apart));
  }
  return bits(query.culls(p, q));
}

/// The tests of as many pairs as `Some` has lanes.
template <class V, int W, bool kGaps, bool kInWorld, class Query>
struct CulledPairs {
  template <class Some>
  [[gnu::always_inline]] static decltype(auto) volumes(const void* from,
                                                       const std::uint32_t* nodes) {
    using Stored = std::conditional_t<kInWorld, Posed<V>, V>;
    const auto* const all = static_cast<const Stored*>(from);
    if constexpr (Batched<Some>)
      return gather<Some>(all, nodes);
    else
      return (all[*nodes]);
  }
  template <class Some>
  [[gnu::always_inline]] static std::uint64_t some(const VolumeTests<Query>& tests,
                                                   const std::uint32_t* nodes_a,
                                                   const std::uint32_t* nodes_b, Query& query,
                                                   float* gaps) {
    if constexpr (kInWorld) {
      return culled<kGaps>(volumes<Some>(tests.volumes_a, nodes_a),
                           volumes<Some>(tests.volumes_b, nodes_b), query, gaps);
    } else {
      const auto& placement = *static_cast<const bvlab::PlacementOf<V>*>(tests.placement);
      using Lanes = Over<Posed<V>, Some>;
      const Lanes in_b = posed(volumes<Some>(tests.volumes_a, nodes_a), placement);
      return culled<kGaps>(
          in_b, static_cast<const Lanes&>(as_stored<V>(volumes<Some>(tests.volumes_b, nodes_b))),
          query, gaps);
    }
  }
  template <class Some>
  [[gnu::noinline, gnu::flatten]] static std::uint64_t call(const VolumeTests<Query>& tests,
                                                            const std::uint32_t* nodes_a,
                                                            const std::uint32_t* nodes_b,
                                                            Query& query, float* gaps) {
    return some<Some>(tests, nodes_a, nodes_b, query, gaps);
  }

  using T = typename V::scalar;
  static constexpr typename VolumeTests<Query>::OfWidths of_widths{
      call<T>, call<OfWidth<T, std::min(W, 4)>>, call<OfWidth<T, W>>};
};

}  // namespace detail

/// The tests of two bodies of volumes V, up to W pairs of nodes at once. The placement, where there
/// is one, lies in the workspace and is valid until the next call.
template <int W, class V, class Query>
VolumeTests<Query> tests_between(TreeBody& body_a, TreeBody& body_b, Workspace& workspace) {
  using detail::CulledPairs;
  auto &a = static_cast<Body<V>&>(body_a), &b = static_cast<Body<V>&>(body_b);
  if constexpr (PlacedRelatively<V>)
    if (a.frame() == Frame::body || a.is_far() || b.is_far()) {
      auto& placement = workspace.template scratch<PlacementOf<V>>();
      placement = relative_placement<V>(RelativePose(a.orthonormal_pose(), b.orthonormal_pose()),
                                        a.hierarchy().extent().reach);
      return {&CulledPairs<V, W, false, false, Query>::of_widths,
              &CulledPairs<V, W, true, false, Query>::of_widths, a.hierarchy().volumes(),
              b.hierarchy().volumes(), &placement};
    }
  return {&CulledPairs<V, W, false, true, Query>::of_widths,
          &CulledPairs<V, W, true, true, Query>::of_widths, a.volumes(), b.volumes(), nullptr};
}
/// The same as a pointer: the placement is made where a traversal begins.
template <class Query>
using TestsBetween = VolumeTests<Query> (*)(TreeBody&, TreeBody&, Workspace&);

}  // namespace bvlab
