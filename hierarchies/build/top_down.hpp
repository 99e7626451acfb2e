// SPDX-License-Identifier: BSD-3-Clause
/// Builds a topology top down, by splitting triangles by their centroids along an axis. O(n log n).
/// Threads share subtrees but not the first splits: on two threads, the 13 levels over 8000
/// triangles take as long as 7 levels on one. The topology does not depend on the number of
/// threads.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/local_mesh.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// The direction of a split: the longest side of the box of the centroids, or the direction in
/// which they spread most (gottschalk1996obbtree).
enum class SplitAxis { longest, principal };

/// The place of a split: equal counts, the mean of the centroids, or the middle of their extent.
/// (Splits of least cost: range_splits.hpp.)
enum class SplitAt { median, mean, middle };

struct TopDown {
  SplitAxis axis = SplitAxis::longest;
  SplitAt at = SplitAt::mean;
  std::uint32_t leaf_size = 1;  ///< the most triangles in a leaf

  template <class = double>
  Topology operator()(const TriangleMesh& mesh) const;
  template <class = double>
  Topology operator()(const TriangleMesh& mesh, Threads& threads) const;
};

namespace detail {

/// Partitions triangles' centroids, not indices: a range is contiguous in memory at any depth.
// A template, so that only those who call it compile it.
template <class = double>
class Splitter {
  using Four = Eigen::Array4d;
  /// A triangle's centroid, and in the fourth number its index in the mesh, exact in double.
  using Item = std::array<double, 4>;

  static Eigen::Map<const Four> four(const Item& item) {
    return Eigen::Map<const Four>(item.data());
  }
  static Eigen::Map<const Vec3<double>> centroid(const Item& item) {
    return Eigen::Map<const Vec3<double>>(item.data());
  }

 public:
  Splitter(const TriangleMesh& mesh, const TopDown& options) : options_(options) {
    items_.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.corners(i);
      const Vec3<double> c = t[0] / 3 + t[1] / 3 + t[2] / 3;
      items_.push_back({c[0], c[1], c[2], static_cast<double>(i)});
    }
  }

  Topology build(Threads& threads) {
    Topology topology;
    const auto count = static_cast<std::uint32_t>(items_.size());
    if (threads.count() == 1 || count < worth_sharing)
      topology.nodes = subtree({{0, count}, extent(items_)});
    else
      topology.nodes = subtrees({{0, count}, extent(items_)}, threads);
    topology.primitives.reserve(items_.size());
    for (const Item& item : items_)
      topology.primitives.push_back(static_cast<std::uint32_t>(item[3]));
    return topology;
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  using Nodes = std::vector<Topology::Node>;
  /// The bounding box of a range's centroids.
  struct Extent {
    Four lo = Four::Constant(infinite), hi = Four::Constant(-infinite);

    void add(const Item& item) { lo = lo.min(four(item)), hi = hi.max(four(item)); }
  };
  struct Range {
    Topology::Node node;
    Extent extent;
  };
  /// Below this many triangles, waking a thread takes longer than a subtree.
  static constexpr std::uint32_t worth_sharing = 1024, subtree_of_one = 256;

  bool is_leaf(std::uint32_t size) const { return size <= std::max(1u, options_.leaf_size); }

  /// The subtree over a range of the items, depth first, left child first; node 0 is its root.
  Nodes subtree(const Range& range) {
    Nodes nodes;
    nodes.reserve(2 * std::size_t{range.node.count} / std::max(1u, options_.leaf_size / 4));
    nodes.push_back(range.node);
    std::vector<std::pair<std::uint32_t, Extent>> open{{0, range.extent}};
    while (!open.empty()) {
      const auto [node, extent] = open.back();
      open.pop_back();
      if (is_leaf(nodes[node].count)) continue;
      const auto [left, right] = split({nodes[node], extent});
      const auto child = static_cast<std::uint32_t>(nodes.size());
      nodes[node] = {child, 0};
      nodes.push_back(left.node);
      nodes.push_back(right.node);
      open.emplace_back(child + 1, right.extent);
      open.emplace_back(child, left.extent);
    }
    return nodes;
  }

  /// A range; large ones are split level by level, the rest become one thread's subtree.
  struct Part {
    Range range;
    std::uint32_t child = 0;  ///< index of the first of two parts; 0 if unsplit
    Nodes below;              ///< the subtree of an unsplit part
  };
  Nodes subtrees(const Range& range, Threads& threads) {
    std::vector<Part> parts{{range, 0, {}}};
    for (std::size_t begin = 0, end; (end = parts.size()) > begin; begin = end) {
      std::vector<Halves> halves(end - begin);
      threads.share(end - begin, [&](std::size_t k, std::size_t) {
        Part& part = parts[begin + k];
        const std::uint32_t size = part.range.node.count;
        if (size <= subtree_of_one || is_leaf(size))
          part.below = subtree(part.range);
        else
          halves[k] = split(part.range);
      });
      for (std::size_t k = begin; k < end; ++k)
        if (const auto& [left, right] = halves[k - begin]; left.node.count > 0) {
          parts[k].child = static_cast<std::uint32_t>(parts.size());
          parts.push_back({left, 0, {}});
          parts.push_back({right, 0, {}});
        }
    }
    // Concatenate the parts in the order that one thread would give.
    Nodes nodes;
    nodes.reserve(2 * std::size_t{range.node.count});
    nodes.push_back(range.node);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, 0}};  // a node, its part
    while (!open.empty()) {
      const auto [node, k] = open.back();
      open.pop_back();
      const Part& part = parts[k];
      const auto next = static_cast<std::uint32_t>(nodes.size());
      if (part.child == 0) {
        const auto placed = [next](const Topology::Node& below) {
          return below.count == 0 ? Topology::Node{below.first + next - 1, 0} : below;
        };
        nodes[node] = placed(part.below[0]);
        for (std::size_t b = 1; b < part.below.size(); ++b) nodes.push_back(placed(part.below[b]));
        continue;
      }
      nodes[node] = {next, 0};
      nodes.push_back(parts[part.child].range.node);
      nodes.push_back(parts[part.child + 1].range.node);
      open.emplace_back(next + 1, part.child + 1);
      open.emplace_back(next, part.child);
    }
    return nodes;
  }

  using Items = std::span<Item>;

  static Extent extent(std::span<const Item> range) {
    Extent extent;
    for (const Item& item : range) extent.add(item);
    return extent;
  }

  struct Halves {
    Range left{{0, 0}, {}}, right{{0, 0}, {}};
  };
  /// Partitions the range for the two children. Neither part is empty.
  Halves split(const Range& range) {
    const Vec3<double> sides = (range.extent.hi - range.extent.lo).template head<3>();
    Eigen::Index longest = 0;
    sides.maxCoeff(&longest);
    if (options_.axis == SplitAxis::longest)
      return split(
          range.node, [longest](const Item& item) { return centroid(item)[longest]; },
          range.extent.lo[longest], range.extent.hi[longest]);
    const Items all = items(range.node);
    const Vec3<double> axis = principal(all, sides, longest);
    const auto key = [&axis](const Item& item) { return dot<double>(axis, centroid(item)); };
    double low = infinite, high = -low;
    for (const Item& item : all) low = std::min(low, key(item)), high = std::max(high, key(item));
    return split(range.node, key, low, high);
  }
  Items items(const Topology::Node& node) { return Items(items_).subspan(node.first, node.count); }

  /// All keys are between `low` and `high`.
  template <class Key>
  Halves split(const Topology::Node& node, const Key& key, double low, double high) {
    const Items range = items(node);
    Extent left_extent, right_extent;
    std::size_t left = 0;
    if (low < high && options_.at != SplitAt::median) {
      const double cut = options_.at == SplitAt::mean ? mean_of(range, key) : low / 2 + high / 2;
      left = partition(
          range, [&](const Item& item) { return key(item) < cut; }, left_extent, right_extent);
    }
    if (left == 0 || left == range.size()) {
      left = range.size() / 2;
      std::nth_element(range.begin(), range.begin() + static_cast<std::ptrdiff_t>(left),
                       range.end(), [&](const Item& a, const Item& b) {
                         return key(a) < key(b) || (key(a) == key(b) && a[3] < b[3]);
                       });
      left_extent = extent(range.first(left)), right_extent = extent(range.subspan(left));
    }
    const auto count = static_cast<std::uint32_t>(left);
    return {{{node.first, count}, left_extent},
            {{node.first + count, node.count - count}, right_extent}};
  }

  /// As std::partition, and computes the extents of both parts: each item is read once.
  template <class IsLeft>
  static std::size_t partition(Items range, const IsLeft& is_left, Extent& left, Extent& right) {
    auto first = range.begin(), last = range.end();
    while (true) {
      while (first != last && is_left(*first)) left.add(*first), ++first;
      if (first == last) break;
      --last;
      while (first != last && !is_left(*last)) right.add(*last), --last;
      right.add(*first);
      if (first == last) break;
      left.add(*last);
      std::swap(*first, *last);
      ++first;
    }
    return static_cast<std::size_t>(first - range.begin());
  }

  template <class Key>
  static double mean_of(Items range, const Key& key) {
    double sum = 0;
    for (const Item& item : range) sum += key(item);
    return sum / static_cast<double>(range.size());
  }

  /// The principal axis of the centroids; `sides` are those of their box.
  static Vec3<double> principal(Items range, const Vec3<double>& sides, Eigen::Index longest) {
    Vec3<double> along_box = Vec3<double>::Unit(longest);
    // Not Eigen's norm: without vector registers it adds in another order, and the last digit of
    // this decides the sign of some axes, and with it which child comes first.
    const double scale = std::sqrt(squared_norm(sides));
    if (!(scale > 0) || !std::isfinite(scale)) return along_box;
    Vec3<double> mean = Vec3<double>::Zero();
    for (const Item& item : range) mean += centroid(item) / static_cast<double>(range.size());
    Mat3<double> covariance = Mat3<double>::Zero();
    for (const Item& item : range) {
      const Vec3<double> d = (centroid(item) - mean) / scale;
      covariance += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(covariance);
    return solver.info() == Eigen::Success ? Vec3<double>(solver.eigenvectors().col(2)) : along_box;
  }

  const TopDown& options_;
  LargeVector<Item> items_;
};

}  // namespace detail

template <class>
Topology TopDown::operator()(const TriangleMesh& mesh, Threads& threads) const {
  return detail::Splitter<>(LocalMesh(mesh).mesh(), *this).build(threads);
}
template <class>
Topology TopDown::operator()(const TriangleMesh& mesh) const {
  Threads alone;
  return (*this)(mesh, alone);
}

}  // namespace bvlab
