// SPDX-License-Identifier: BSD-3-Clause
/// THE list of ways to build a topology, each a builder and its options under one name. A mesh has
/// at least one triangle; its vertices are finite.
#pragma once

#include <cstdint>
#include <string_view>

#include "hierarchies/build/bottom_up.hpp"
#include "hierarchies/build/range_splits.hpp"
#include "hierarchies/build/top_down.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/type_list.hpp"

namespace bvlab {

namespace builds {

template <SplitAxis kAxis, SplitAt kAt>
struct Down {
  static Topology topology(const TriangleMesh& mesh, std::uint32_t leaf_size) {
    return TopDown{kAxis, kAt, leaf_size}(mesh);
  }
  /// The same, on several threads.
  static Topology topology(const TriangleMesh& mesh, std::uint32_t leaf_size, Threads& threads) {
    return TopDown{kAxis, kAt, leaf_size}(mesh, threads);
  }
};

struct TopDownMean : Down<SplitAxis::longest, SplitAt::mean> {
  static constexpr std::string_view name = "top-down-mean";
  static constexpr std::string_view description = "longest axis, at the mean of the centroids";
};
struct TopDownMedian : Down<SplitAxis::longest, SplitAt::median> {
  static constexpr std::string_view name = "top-down-median";
  static constexpr std::string_view description = "longest axis, equal counts";
};
struct TopDownMiddle : Down<SplitAxis::longest, SplitAt::middle> {
  static constexpr std::string_view name = "top-down-middle";
  static constexpr std::string_view description =
      "longest axis, in the middle of the centroids' box, as octrees cut space (Hubbard 1996)";
};
struct TopDownPrincipal : Down<SplitAxis::principal, SplitAt::mean> {
  static constexpr std::string_view name = "top-down-principal";
  static constexpr std::string_view description =
      "principal axis of the centroids, at their mean (Gottschalk 1996)";
};
struct BottomUpLocal {
  static constexpr std::string_view name = "bottom-up";
  static constexpr std::string_view description =
      "clusters that choose each other merge (Meister and Bittner 2018)";
  template <class = double>
  static Topology topology(const TriangleMesh& mesh, std::uint32_t leaf_size) {
    return BottomUp{leaf_size}(mesh);
  }
  /// The same, on several threads.
  template <class = double>
  static Topology topology(const TriangleMesh& mesh, std::uint32_t leaf_size, Threads& threads) {
    return BottomUp{leaf_size}(mesh, threads);
  }
};
struct TopDownSurfaceArea {
  static constexpr std::string_view name = "top-down-surface-area";
  static constexpr std::string_view description =
      "surface-area heuristic over 32 bins, along the best axis";
  template <class = double>
  static Topology topology(const TriangleMesh& mesh, std::uint32_t leaf_size) {
    Threads alone;
    return topology(mesh, leaf_size, alone);
  }
  /// The same, on several threads.
  template <class = double>
  static Topology topology(const TriangleMesh& mesh, std::uint32_t leaf_size, Threads& threads) {
    return RangeSplits(LocalMesh(mesh).mesh()).binary(leaf_size, threads);
  }
};
/// Where a hierarchy has a function `on_demand`, that makes the tree; elsewhere it is made at once.
struct OnDemand : TopDownSurfaceArea {
  static constexpr std::string_view name = "on-demand";
  static constexpr std::string_view description =
      "the same splits; of slab-boxes with kernel siblings a node is made when a traversal first "
      "opens it";
};

}  // namespace builds

using Builds = TypeList<builds::TopDownPrincipal, builds::TopDownMean, builds::TopDownMedian,
                        builds::TopDownMiddle, builds::TopDownSurfaceArea, builds::BottomUpLocal,
                        builds::OnDemand>;

}  // namespace bvlab
