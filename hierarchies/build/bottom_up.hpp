// SPDX-License-Identifier: BSD-3-Clause
/// Builds a topology bottom up by clustering, as li1998incremental builds its sphere tree: a
/// cluster merges with the neighbour of smallest union, until one is left.
///
/// Locally-ordered clustering (meister2018parallel): clusters are kept in Morton order, each finds
/// its partner among `radius` neighbours on either side, and pairs that choose each other merge.
/// O(n radius), also on equal costs, instead of the O(n^2) of the exact greedy rule. Threads share
/// the search for partners, which is nearly all of the work; the topology does not depend on their
/// number.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/morton.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct BottomUp {
  std::uint32_t leaf_size = 1;  ///< the most triangles in a leaf
  std::uint32_t radius = 16;    ///< neighbours examined on either side

  Topology operator()(const TriangleMesh& mesh) const;
  Topology operator()(const TriangleMesh& mesh, Threads& threads) const;
};

namespace detail {

class Clustering {
 public:
  Clustering(const TriangleMesh& mesh, const BottomUp& options) : options_(options) {
    const std::size_t count = mesh.triangles.size();
    boxes_.resize(count);
    Eigen::AlignedBox3d all;
    for (std::size_t i = 0; i < count; ++i) {
      for (const auto& corner : mesh.corners(i)) boxes_[i].extend(corner);
      all.extend(boxes_[i]);
    }
    active_.resize(count);
    std::iota(active_.begin(), active_.end(), 0u);
    std::vector<std::uint64_t> codes(count);
    for (std::size_t i = 0; i < count; ++i) codes[i] = morton_code(boxes_[i].center(), all);
    std::stable_sort(active_.begin(), active_.end(),
                     [&](auto i, auto j) { return codes[i] < codes[j]; });
    children_.resize(count);
    sizes_.assign(count, 1);
  }

  Topology build(Threads& threads) {
    while (active_.size() > 1) merge_round(threads);
    return flattened();
  }

 private:
  struct Children {
    std::uint32_t left = 0, right = 0;
  };
  /// Below this many clusters, waking a thread takes longer than the search.
  static constexpr std::size_t worth_sharing = 256;
  /// At least one cluster in this many merges per round, so that n clusters take O(log n) rounds.
  static constexpr std::size_t fewest_mutual = 64;

  double cost(std::uint32_t i, std::uint32_t j) const {
    const Vec3<double> d = boxes_[i].merged(boxes_[j]).sizes();
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }

  /// One round of merges. Clusters are numbered by their position in `active_`. Every range
  /// compares neighbours in the same order, so that ties are broken alike on any number of threads.
  void merge_round(Threads& threads) {
    const std::size_t n = active_.size(), radius = std::max(1u, options_.radius);
    std::vector<std::size_t> partner(n, n);
    std::vector<double> least(n, std::numeric_limits<double>::infinity());
    const auto propose = [&](std::size_t i, std::size_t j, double c) {
      if (partner[i] == n || c < least[i]) least[i] = c, partner[i] = j;
    };
    threads.share_out(n, worth_sharing, [&](std::size_t begin, std::size_t end, std::size_t) {
      // Clusters before the range belong to another thread, but neighbour the range's first.
      for (std::size_t i = begin - std::min(begin, radius); i < begin; ++i)
        for (std::size_t j = begin; j < std::min(end, i + radius + 1); ++j)
          propose(j, i, cost(active_[i], active_[j]));
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t j = i + 1; j < std::min(n, i + radius + 1); ++j) {
          const double c = cost(active_[i], active_[j]);
          propose(i, j, c);
          if (j < end) propose(j, i, c);
        }
    });
    std::size_t mutual = 0;
    for (std::size_t i = 0; i < n; ++i) mutual += i < partner[i] && partner[partner[i]] == i;
    if (mutual * fewest_mutual < n) pair_more(partner, least);
    std::vector<std::uint32_t> next;
    next.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = partner[i];
      if (partner[j] != i || i == j)
        next.push_back(active_[i]);
      else if (i < j)
        next.push_back(merged(active_[i], active_[j]));
    }
    active_ = std::move(next);
  }

  /// Where equal costs (or costs that fall from one cluster to the next) leave few mutual choices,
  /// as among identical triangles: the rest pair in order, each with the nearest free cluster of
  /// least cost. At least one in 4 radius + 2 clusters finds a partner this way.
  void pair_more(std::vector<std::size_t>& partner, const std::vector<double>& least) const {
    const std::size_t n = active_.size(), radius = std::max(1u, options_.radius);
    const auto pair = [&](std::size_t i, std::size_t j) { partner[i] = j, partner[j] = i; };
    std::vector<char> paired(n);
    for (std::size_t i = 0; i < n; ++i) paired[i] = partner[partner[i]] == i;
    const auto costs_least = [&](std::size_t i, std::size_t j) {
      return !paired[j] && (j == partner[i] || cost(active_[i], active_[j]) == least[i]);
    };
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t off = 1; off <= radius && !paired[i]; ++off) {
        std::size_t j = n;
        if (off <= i && costs_least(i, i - off))
          j = i - off;
        else if (i + off < n && costs_least(i, i + off))
          j = i + off;
        if (j < n) pair(i, j), paired[i] = paired[j] = true;
      }
    }
    // A cluster without a partner is kept unmerged, whatever it had chosen.
    for (std::size_t i = 0; i < n; ++i)
      if (!paired[i]) partner[i] = i;
  }

  std::uint32_t merged(std::uint32_t i, std::uint32_t j) {
    boxes_.push_back(boxes_[i].merged(boxes_[j]));
    children_.push_back({i, j});
    sizes_.push_back(sizes_[i] + sizes_[j]);
    return static_cast<std::uint32_t>(boxes_.size() - 1);
  }

  bool is_leaf(std::uint32_t cluster) const {
    return sizes_[cluster] <= std::max(1u, options_.leaf_size);
  }

  void collect(std::uint32_t cluster, std::vector<std::uint32_t>& primitives) const {
    std::vector<std::uint32_t> open{cluster};
    while (!open.empty()) {
      const auto c = open.back();
      open.pop_back();
      if (sizes_[c] == 1)
        primitives.push_back(c);
      else
        open.push_back(children_[c].right), open.push_back(children_[c].left);
    }
  }

  Topology flattened() const {
    Topology topology;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, active_.front()}};
    topology.nodes.emplace_back();
    while (!open.empty()) {
      const auto [node, cluster] = open.back();
      open.pop_back();
      if (is_leaf(cluster)) {
        topology.nodes[node] = {static_cast<std::uint32_t>(topology.primitives.size()),
                                sizes_[cluster]};
        collect(cluster, topology.primitives);
        continue;
      }
      const auto child = static_cast<std::uint32_t>(topology.nodes.size());
      topology.nodes[node] = {child, 0};
      topology.nodes.resize(topology.nodes.size() + 2);
      open.emplace_back(child + 1, children_[cluster].right);
      open.emplace_back(child, children_[cluster].left);
    }
    return topology;
  }

  const BottomUp& options_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<Children> children_;
  std::vector<std::uint32_t> sizes_;
  std::vector<std::uint32_t> active_;
};

}  // namespace detail

inline Topology BottomUp::operator()(const TriangleMesh& mesh, Threads& threads) const {
  return detail::Clustering(LocalMesh(mesh).mesh(), *this).build(threads);
}
inline Topology BottomUp::operator()(const TriangleMesh& mesh) const {
  Threads alone;
  return (*this)(mesh, alone);
}

}  // namespace bvlab
