// SPDX-License-Identifier: BSD-3-Clause
/// Top-down: split the triangles by their centroids along an axis, and again, down to leaves.
/// O(n log n). Threads share subtrees, the first splits are one's alone: 13 levels of 8000
/// triangles take 7 on two threads. The topology is the same for any number of them.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// Along which direction to split: the longest side of the centroids' box, or the direction in
/// which they spread most (gottschalk1996obbtree).
enum class SplitAxis { longest, principal };

/// Where: equal counts on both sides, the mean of the centroids, or the least expected cost by the
/// surface-area heuristic over 32 bins (goldsmith1987automatic, wald2007fast).
enum class SplitAt { median, mean, middle, surface_area };

struct TopDown {
  SplitAxis axis = SplitAxis::longest;
  SplitAt at = SplitAt::mean;
  std::uint32_t leaf_size = 1;  ///< the most triangles in a leaf

  Topology operator()(const TriangleMesh& mesh) const;
  Topology operator()(const TriangleMesh& mesh, Threads& threads) const;
};

namespace detail {

class Splitter {
 public:
  Splitter(const TriangleMesh& mesh, const TopDown& options)
      : mesh_(mesh), options_(options), keys_(mesh.triangles.size()) {
    centroids_.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto [a, b, c] = mesh.corners(i);
      centroids_.push_back(a / 3 + b / 3 + c / 3);
    }
  }

  Topology build(Threads& threads) {
    Topology topology;
    topology.primitives.resize(centroids_.size());
    std::iota(topology.primitives.begin(), topology.primitives.end(), 0u);
    const auto count = static_cast<std::uint32_t>(centroids_.size());
    if (threads.count() == 1 || count < worth_sharing)
      topology.nodes = subtree({0, count}, topology.primitives);
    else
      topology.nodes = subtrees({0, count}, topology.primitives, threads);
    return topology;
  }

 private:
  using Nodes = std::vector<Topology::Node>;
  /// Below this a thread takes longer to wake than a subtree does.
  static constexpr std::uint32_t worth_sharing = 1024, subtree_of_one = 256;

  bool is_leaf(std::uint32_t size) const { return size <= std::max(1u, options_.leaf_size); }

  /// What is below a range of the primitives, the left half first; node 0 is the range itself.
  Nodes subtree(const Topology::Node& range, std::span<std::uint32_t> primitives) {
    Nodes nodes;
    nodes.reserve(2 * std::size_t{range.count});
    nodes.push_back(range);
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const std::uint32_t node = open.back();
      open.pop_back();
      const auto [first, size] = nodes[node];
      if (is_leaf(size)) continue;
      const std::uint32_t left = split(primitives.subspan(first, size));
      const auto child = static_cast<std::uint32_t>(nodes.size());
      nodes[node] = {child, 0};
      nodes.push_back({first, left});
      nodes.push_back({first + left, size - left});
      open.push_back(child + 1);
      open.push_back(child);
    }
    return nodes;
  }

  /// A range, split level by level until one thread does what is below it.
  struct Part {
    Topology::Node range;
    std::uint32_t child = 0;  ///< the first of two parts; 0 where there are none
    Nodes below;              ///< its subtree, where there are none
  };
  Nodes subtrees(const Topology::Node& range, std::span<std::uint32_t> primitives,
                 Threads& threads) {
    std::vector<Part> parts{{range, 0, {}}};
    for (std::size_t begin = 0, end; (end = parts.size()) > begin; begin = end) {
      std::vector<std::uint32_t> left(end - begin);
      threads.share(end - begin, [&](std::size_t k, std::size_t) {
        Part& part = parts[begin + k];
        const auto [first, size] = part.range;
        if (size <= subtree_of_one || is_leaf(size))
          part.below = subtree(part.range, primitives);
        else
          left[k] = split(primitives.subspan(first, size));
      });
      for (std::size_t k = begin; k < end; ++k)
        if (const std::uint32_t here = left[k - begin]; here > 0) {
          const auto [first, size] = parts[k].range;
          parts[k].child = static_cast<std::uint32_t>(parts.size());
          parts.push_back({{first, here}, 0, {}});
          parts.push_back({{first + here, size - here}, 0, {}});
        }
    }
    // In the order in which one thread would have come to them.
    Nodes nodes;
    nodes.reserve(2 * std::size_t{range.count});
    nodes.push_back(range);
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
      nodes.push_back(parts[part.child].range);
      nodes.push_back(parts[part.child + 1].range);
      open.emplace_back(next + 1, part.child + 1);
      open.emplace_back(next, part.child);
    }
    return nodes;
  }

  /// Orders the range so that its first part goes to the left child; gives that part's size, which
  /// is neither zero nor all.
  std::uint32_t split(std::span<std::uint32_t> range) {
    const Vec3<double> axis = direction(range);
    double low = std::numeric_limits<double>::infinity(), high = -low, sum = 0;
    for (const auto i : range) {
      const double key = keys_[i] = axis.dot(centroids_[i]);
      low = std::min(low, key), high = std::max(high, key), sum += key;
    }
    std::size_t left = 0;
    if (low < high && options_.at != SplitAt::median) {
      const double cut = options_.at == SplitAt::mean     ? sum / static_cast<double>(range.size())
                         : options_.at == SplitAt::middle ? low / 2 + high / 2
                                                          : cheapest_cut(range, low, high);
      left = static_cast<std::size_t>(
          std::partition(range.begin(), range.end(), [&](auto i) { return keys_[i] < cut; }) -
          range.begin());
    }
    if (left == 0 || left == range.size()) {
      left = range.size() / 2;
      std::nth_element(
          range.begin(), range.begin() + static_cast<std::ptrdiff_t>(left), range.end(),
          [&](auto i, auto j) { return keys_[i] < keys_[j] || (keys_[i] == keys_[j] && i < j); });
    }
    return static_cast<std::uint32_t>(left);
  }

  Vec3<double> direction(std::span<const std::uint32_t> range) const {
    Eigen::AlignedBox3d box;
    Vec3<double> mean = Vec3<double>::Zero();
    for (const auto i : range) {
      box.extend(centroids_[i]);
      mean += centroids_[i] / static_cast<double>(range.size());
    }
    Eigen::Index longest = 0;
    (box.max() - box.min()).maxCoeff(&longest);
    const Vec3<double> along_box = Vec3<double>::Unit(longest);
    if (options_.axis == SplitAxis::longest) return along_box;
    Mat3<double> covariance = Mat3<double>::Zero();
    const double scale = box.diagonal().norm();
    if (!(scale > 0) || !std::isfinite(scale)) return along_box;
    for (const auto i : range) {
      const Vec3<double> d = (centroids_[i] - mean) / scale;
      covariance += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(covariance);
    return solver.info() == Eigen::Success ? Vec3<double>(solver.eigenvectors().col(2)) : along_box;
  }

  /// The cut between bins with the least (area x count) summed over both sides.
  double cheapest_cut(std::span<const std::uint32_t> range, double low, double high) const {
    constexpr std::size_t bins = 32;
    std::array<Eigen::AlignedBox3d, bins> boxes;
    std::array<std::size_t, bins> counts{};
    const double per_unit = bins / (high - low);
    const auto bin_of = [&](double key) {
      return std::min(bins - 1, static_cast<std::size_t>((key - low) * per_unit));
    };
    for (const auto i : range) {
      const std::size_t bin = bin_of(keys_[i]);
      ++counts[bin];
      for (const auto& corner : mesh_.corners(i)) boxes[bin].extend(corner);
    }
    std::array<double, bins> right_cost{};
    Eigen::AlignedBox3d box;
    std::size_t count = 0;
    for (std::size_t bin = bins - 1; bin > 0; --bin) {
      box.extend(boxes[bin]), count += counts[bin];
      right_cost[bin] = half_area(box) * static_cast<double>(count);
    }
    double best = std::numeric_limits<double>::infinity(), cut = low;
    box.setEmpty(), count = 0;
    for (std::size_t bin = 1; bin < bins; ++bin) {
      box.extend(boxes[bin - 1]), count += counts[bin - 1];
      const double cost = half_area(box) * static_cast<double>(count) + right_cost[bin];
      if (count > 0 && count < range.size() && cost < best)
        best = cost, cut = low + static_cast<double>(bin) / per_unit;
    }
    return cut;
  }

  static double half_area(const Eigen::AlignedBox3d& box) {
    if (box.isEmpty()) return 0;
    const Vec3<double> d = box.sizes();
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }

  const TriangleMesh& mesh_;
  const TopDown& options_;
  std::vector<Vec3<double>> centroids_;
  std::vector<double> keys_;
};

}  // namespace detail

inline Topology TopDown::operator()(const TriangleMesh& mesh, Threads& threads) const {
  return detail::Splitter(mesh, *this).build(threads);
}
inline Topology TopDown::operator()(const TriangleMesh& mesh) const {
  Threads alone;
  return (*this)(mesh, alone);
}

}  // namespace bvlab
