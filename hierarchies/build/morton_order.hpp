// SPDX-License-Identifier: BSD-3-Clause
/// A mesh's triangles in the order of their centroids along a Morton curve (lauterbach2009fast),
/// and trees whose nodes are ranges of that order, cut where the codes differ most. O(n).
///
/// Triangles are sorted by 30 bits of their codes. A run of more than 16 equal ones is sorted by
/// all 63, so that one far triangle, or details in one cell, cost only that run.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/morton.hpp"
#include "hierarchies/geometry/radix_sort.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

class MortonOrder {
 public:
  /// `box` is around all triangles, of which there is at least one.
  MortonOrder(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box, Threads& threads)
      : items_(mesh.triangles.size()) {
    // Of a cube, so that a flat mesh spends no bits on its thin axis.
    const double side = (box.max() - box.min()).maxCoeff();
    const Eigen::AlignedBox3d cube(box.min(), box.min() + Vec3<double>::Constant(side));
    const auto code = [&](std::size_t k) {
      const auto& [a, b, c] = mesh.triangles[k];
      return morton_code((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3, cube);
    };
    threads.share_out(items_.size(), 4096, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t k = begin; k < end; ++k)
        items_[k] = {static_cast<std::uint32_t>(code(k) >> (63 - coarse_bits)),
                     static_cast<std::uint32_t>(k)};
    });
    LargeVector<Item> spare;
    radix_sort(items_, spare, coarse_bits, threads);
    for (std::size_t k = 0; k + crowd < items_.size();) {
      if (items_[k + crowd].key != items_[k].key) {
        ++k;
        continue;
      }
      std::vector<Keyed<std::uint64_t>> run;
      const std::size_t first = k;
      for (; k < items_.size() && items_[k].key == items_[first].key; ++k)
        run.push_back({code(items_[k].id), items_[k].id});
      std::sort(run.begin(), run.end(), [](const auto& a, const auto& b) {
        return a.key != b.key ? a.key < b.key : a.id < b.id;
      });
      for (std::size_t i = 0; i < run.size(); ++i) items_[first + i].id = run[i].id;
    }
  }

  /// The triangles' indices, in order.
  std::vector<std::uint32_t> indices() const {
    std::vector<std::uint32_t> indices(items_.size());
    for (std::size_t k = 0; k < items_.size(); ++k) indices[k] = items_[k].id;
    return indices;
  }

  /// The binary tree: a range is cut where the highest bit changes in which its codes differ, in
  /// the middle where they are equal.
  Topology binary(std::uint32_t leaf_size) const {
    Topology topology;
    topology.primitives = indices();
    struct Range {
      std::uint32_t node, begin, end;
    };
    std::vector<Range> open{{0, 0, static_cast<std::uint32_t>(items_.size())}};
    topology.nodes.emplace_back();
    while (!open.empty()) {
      const auto [node, begin, end] = open.back();
      open.pop_back();
      if (end - begin <= leaf_size) {
        topology.nodes[node] = {begin, end - begin};
        continue;
      }
      const auto first = static_cast<std::uint32_t>(topology.nodes.size());
      topology.nodes[node] = {first, 0};
      topology.nodes.resize(first + 2);
      const std::uint32_t cut = highest_change(begin, end);
      open.push_back({first + 1, cut, end}), open.push_back({first, begin, cut});
    }
    return topology;
  }

  /// The wide tree, all leaves on one level, made from below: each node takes between half of
  /// `fan_out` (of `leaf_size` triangles) and all, and ends where the codes differ in the highest
  /// bit.
  WideTopology wide(std::uint32_t fan_out, std::uint32_t leaf_size) const {
    const auto all = static_cast<std::uint32_t>(items_.size());
    // Where the nodes of a level begin among the triangles, and among those of the level below.
    std::vector<std::vector<std::uint32_t>> begins, firsts;
    std::vector<std::uint32_t> below(all + 1);
    for (std::uint32_t k = 0; k <= all; ++k) below[k] = k;
    for (std::uint32_t most = leaf_size; begins.empty() || begins.back().size() > 2;
         most = fan_out) {
      auto& begin = begins.emplace_back();
      auto& first = firsts.emplace_back();
      const auto end = static_cast<std::uint32_t>(below.size() - 1);
      for (std::uint32_t k = 0; k < end; k = end_of(below, k, most))
        first.push_back(k), begin.push_back(below[k]);
      first.push_back(end), begin.push_back(all);
      below = begin;
    }
    WideTopology wide;
    wide.primitives = indices();
    for (std::size_t level = begins.size(); level-- > 0;) {
      const auto next = static_cast<std::uint32_t>(wide.nodes.size() + begins[level].size() - 1);
      for (std::size_t k = 0; k + 1 < begins[level].size(); ++k) {
        const auto first = firsts[level][k];
        wide.nodes.push_back({level > 0 ? next + first : first, firsts[level][k + 1] - first,
                              level == 0, begins[level][k], begins[level][k + 1]});
      }
    }
    return wide;
  }

 private:
  using Item = Keyed<std::uint32_t>;
  static constexpr std::size_t crowd = 16;
  static constexpr int coarse_bits = 30;

  /// The codes' highest different bit between the triangles before and after a cut.
  std::uint32_t change(std::uint32_t cut) const {
    return std::bit_floor(items_[cut - 1].key ^ items_[cut].key);
  }
  std::uint32_t highest_change(std::uint32_t begin, std::uint32_t end) const {
    const std::uint32_t bit = std::bit_floor(items_[begin].key ^ items_[end - 1].key);
    if (bit == 0) return begin + (end - begin) / 2;
    const auto at = std::partition_point(items_.begin() + begin, items_.begin() + end,
                                         [bit](const Item& item) { return !(item.key & bit); });
    return static_cast<std::uint32_t>(at - items_.begin());
  }
  /// Where the node ends that begins at `first` of the level below, and has at most `most` of it.
  std::uint32_t end_of(const std::vector<std::uint32_t>& below, std::uint32_t first,
                       std::uint32_t most) const {
    const auto end = static_cast<std::uint32_t>(below.size() - 1);
    if (end - first <= most) return end;
    std::uint32_t best = first + most, highest = change(below[best]);
    // At least two, so that each level is smaller than the one below.
    for (std::uint32_t k = best; --k >= first + std::max(2u, most / 2);)
      if (const std::uint32_t bit = change(below[k]); bit > highest) best = k, highest = bit;
    return best;
  }

  LargeVector<Item> items_;
};

}  // namespace bvlab
