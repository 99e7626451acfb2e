// SPDX-License-Identifier: BSD-3-Clause
/// Builds a topology bottom up by clustering, as li1998incremental builds its sphere tree: a
/// cluster merges with the neighbour of smallest union, until one is left.
///
/// Locally-ordered clustering (meister2018parallel): clusters are kept in Morton order, each finds
/// its partner among `radius` neighbours on either side, and pairs that choose each other merge.
/// O(n radius), also on equal costs, instead of the O(n^2) of the exact greedy rule. Threads share
/// the search for partners, about half of the work; the topology does not depend on their
/// number.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/morton.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

struct BottomUp {
  std::uint32_t leaf_size = 1;  ///< the most triangles in a leaf
  std::uint32_t radius = 16;    ///< neighbours examined on either side

  template <class = double>
  Topology operator()(const TriangleMesh& mesh) const;
  template <class = double>
  Topology operator()(const TriangleMesh& mesh, Threads& threads) const;
};

namespace detail {

// A template, so that only those who call it compile it.
template <class = double>
class Clustering {
 public:
  Clustering(const TriangleMesh& mesh, const BottomUp& options) : options_(options) {
    const std::size_t count = mesh.triangles.size();
    boxes_.reserve(2 * count), children_.reserve(2 * count), sizes_.reserve(2 * count);
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
  using Several = stdx::native_simd<double>;
  struct Children {
    std::uint32_t left = 0, right = 0;
  };
  /// Below this many clusters, waking a thread takes longer than the search.
  static constexpr std::size_t worth_sharing = 256;
  /// At least one cluster in this many merges per round, so that n clusters take O(log n) rounds.
  static constexpr std::size_t fewest_mutual = 64;

  /// The cost of a merge: half the surface of the union of two boxes. S is a number or a register.
  template <class S>
  static S cost(const std::array<S, 6>& a, const std::array<S, 6>& b) {
    using std::max, std::min;
    std::array<S, 3> d;
    for (std::size_t k = 0; k < 3; ++k) d[k] = max(a[3 + k], b[3 + k]) - min(a[k], b[k]);
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }

  /// One round of merges. Clusters are numbered by their position in `active_`.
  void merge_round(Threads& threads) {
    const std::size_t n = active_.size();
    std::vector<double> found(n), least(n, std::numeric_limits<double>::infinity());
    line_up();
    threads.share_out(n, worth_sharing, [&](std::size_t begin, std::size_t end, std::size_t) {
      find_partners(begin, end, found, least);
    });
    std::vector<std::size_t> partner(found.begin(), found.end());
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

  /// Copies the boxes of active clusters in their order, side by side. Vacant lanes behind them
  /// cost infinity.
  void line_up() {
    const std::size_t n = active_.size();
    for (std::size_t k = 0; k < 6; ++k) {
      const int axis = static_cast<int>(k % 3);
      lanes_[k].resize(n + Several::size());
      for (std::size_t i = 0; i < n; ++i) {
        const Eigen::AlignedBox3d& box = boxes_[active_[i]];
        lanes_[k][i] = k < 3 ? box.min()[axis] : box.max()[axis];
      }
      const double infinity = std::numeric_limits<double>::infinity();
      std::fill_n(lanes_[k].begin() + static_cast<std::ptrdiff_t>(n), Several::size(),
                  k < 3 ? -infinity : infinity);
    }
  }
  double cost(std::size_t i, std::size_t j) const {
    std::array<double, 6> a, b;
    for (std::size_t k = 0; k < 6; ++k) a[k] = lanes_[k][i], b[k] = lanes_[k][j];
    return cost(a, b);
  }

  /// Finds the partners of a range, several at a time: of the neighbours that cost least the first
  /// one, on any number of threads.
  void find_partners(std::size_t begin, std::size_t end, std::vector<double>& partner,
                     std::vector<double>& least) const {
    const std::size_t n = active_.size(), radius = std::max(1u, options_.radius),
                      width = Several::size();
    const Several lane([](auto i) { return static_cast<double>(i()); }),
        infinity(std::numeric_limits<double>::infinity());
    // Where no cost is finite: the cluster before; for the first, the one after.
    for (std::size_t i = begin; i < end; ++i) partner[i] = i > 0 ? static_cast<double>(i) - 1 : 1;
    for (std::size_t i = begin - std::min(begin, radius); i < end; ++i) {
      std::array<Several, 6> own, others;
      for (std::size_t k = 0; k < 6; ++k) own[k] = lanes_[k][i];
      for (std::size_t j = std::max(begin, i + 1); j < std::min(n, i + radius + 1); j += width) {
        for (std::size_t k = 0; k < 6; ++k)
          others[k].copy_from(&lanes_[k][j], stdx::element_aligned);
        Several costs = cost(own, others);
        // Lanes beyond the radius, and what overflows to infinity or NaN.
        stdx::where(lane > Several(static_cast<double>(i + radius - j)) || !(costs < infinity),
                    costs) = infinity;
        if (const double c = stdx::hmin(costs); i >= begin && c < least[i])
          least[i] = c,
          partner[i] = static_cast<double>(j) + std::countr_zero(bits(costs == Several(c)));
        if (j + width <= end) {
          Several least_of(&least[j], stdx::element_aligned),
              of(&partner[j], stdx::element_aligned);
          const auto less = costs < least_of;
          stdx::where(less, least_of) = costs;
          stdx::where(less, of) = Several(static_cast<double>(i));
          least_of.copy_to(&least[j], stdx::element_aligned);
          of.copy_to(&partner[j], stdx::element_aligned);
        } else {
          for (std::size_t l = 0; j + l < end; ++l)
            if (costs[l] < least[j + l])
              least[j + l] = costs[l], partner[j + l] = static_cast<double>(i);
        }
      }
    }
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
      return !paired[j] && (j == partner[i] || cost(i, j) == least[i]);
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
  std::array<std::vector<double>, 6> lanes_;  // their boxes: the low sides, then the high ones
};

}  // namespace detail

template <class>
Topology BottomUp::operator()(const TriangleMesh& mesh, Threads& threads) const {
  return detail::Clustering<>(LocalMesh(mesh).mesh(), *this).build(threads);
}
template <class>
Topology BottomUp::operator()(const TriangleMesh& mesh) const {
  Threads alone;
  return (*this)(mesh, alone);
}

}  // namespace bvlab
