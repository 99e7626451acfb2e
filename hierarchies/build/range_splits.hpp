// SPDX-License-Identifier: BSD-3-Clause
/// A mesh's triangles in an array whose ranges are split on request, by the surface-area heuristic
/// (goldsmith1987automatic, wald2007fast), so that a tree can be made where somebody looks. A split
/// reads its range alone: ranges that do not overlap can be split by different threads, in any
/// order, and the tree is always the same. O(n log F) for one of n triangles into F parts, about 10
/// ns a triangle for each factor of two.
///
/// Triangles are known by their boxes in float, rounded outwards, and their centroids. A part's box
/// is the union of its triangles' boxes. Of a range's parts that with the largest box is split next
/// (wald2008getting), along the longest side of the box around its centroids.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hierarchies/build/topology.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

class RangeSplits {
 public:
  using Four = Batch<float, 4>;  ///< three coordinates; the fourth means nothing

  struct Range {
    std::uint32_t begin, end;

    std::uint32_t size() const { return end - begin; }
  };
  struct Box {
    Four low = Four(std::numeric_limits<float>::infinity()), high = -low;

    [[gnu::always_inline]] void add(const Box& other) {
      low = stdx::min(low, other.low), high = stdx::max(high, other.high);
    }
    /// Half the surface area.
    float area() const {
      const Four d = high - low;
      return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
  };
  /// A range, the box around its triangles, and that around their centroids.
  struct Part {
    Range range;
    Box box, centroids;
    float priority = -1;  ///< of being split; negative where it is not to be
  };
  static constexpr std::uint32_t most_parts = 16;
  using Parts = std::array<Part, most_parts>;

  explicit RangeSplits(const TriangleMesh& mesh) : items_(mesh.triangles.size()) {
    for (std::size_t k = 0; k < items_.size(); ++k)
      items_[k].put(mesh.corners(k), static_cast<std::uint32_t>(k));
  }

  Range all() const { return {0, static_cast<std::uint32_t>(items_.size())}; }
  /// The mesh's index of triangle k of the order.
  std::uint32_t triangle(std::uint32_t k) const { return items_[k].triangle(); }

  /// Splits a range of more than `leaf_size` triangles into at least two and at most `most` parts,
  /// in order, and returns their number. A part of at most `leaf_size` triangles is not split any
  /// further. Does not throw. A range that has been split already is split into the same parts,
  /// which remain as they are.
  std::uint32_t split(const Range& range, std::uint32_t most, std::uint32_t leaf_size,
                      Parts& parts) {
    parts[0] = around(range);
    parts[0].priority = 1;
    std::uint32_t count = 1;
    while (count < most) {
      std::uint32_t next = 0;
      for (std::uint32_t k = 1; k < count; ++k)
        if (parts[k].priority > parts[next].priority) next = k;
      if (parts[next].priority < 0) break;
      for (std::uint32_t k = count++; k > next + 1; --k) parts[k] = parts[k - 1];
      const Part whole = parts[next];
      cut(whole, parts[next], parts[next + 1]);
      for (Part* part : {&parts[next], &parts[next + 1]})
        part->priority = part->range.size() <= leaf_size ? -1 : part->box.area();
    }
    return count;
  }

  /// How many nodes and leaves the tree has whose nodes are split into at most `most` parts.
  std::pair<std::size_t, std::size_t> sizes(std::uint32_t most, std::uint32_t leaf_size) {
    std::size_t nodes = 0, leaves = 0;
    Parts parts;
    for (std::vector<Range> open{all()}; !open.empty();) {
      const Range range = open.back();
      open.pop_back();
      ++nodes, leaves += range.size() <= leaf_size;
      if (range.size() <= leaf_size) continue;
      const std::uint32_t count = split(range, most, leaf_size, parts);
      for (std::uint32_t k = 0; k < count; ++k) open.push_back(parts[k].range);
    }
    return {nodes, leaves};
  }

  /// The binary tree, made to its end.
  Topology binary(std::uint32_t leaf_size) {
    Topology topology;
    std::vector<Range> ranges{all()};
    topology.nodes.resize(1);
    Parts parts;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const Range range = ranges[i];
      if (range.size() <= leaf_size) {
        topology.nodes[i] = {range.begin, range.size()};
        continue;
      }
      split(range, 2, leaf_size, parts);
      topology.nodes[i] = {static_cast<std::uint32_t>(ranges.size()), 0};
      for (int k = 0; k < 2; ++k) ranges.push_back(parts[k].range), topology.nodes.emplace_back();
    }
    for (std::uint32_t k = 0; k < items_.size(); ++k) topology.primitives.push_back(triangle(k));
    return topology;
  }

 private:
  /// The box of a triangle, its centroid, and in the fourth number of `high` its index in the mesh.
  struct alignas(16) Item {
    std::array<float, 4> low, high, centroid;

    void put(const Triangle& t, std::uint32_t index) {
      const Vec3<double> least = t[0].cwiseMin(t[1]).cwiseMin(t[2]),
                         most = t[0].cwiseMax(t[1]).cwiseMax(t[2]),
                         mean = t[0] / 3 + t[1] / 3 + t[2] / 3;
      const auto widened = [](double x, float by) {
        const auto y = static_cast<float>(x);
        return y + by * (std::abs(y) * (8 * unit_roundoff<float>)+4 *
                         std::numeric_limits<float>::denorm_min());
      };
      for (int k = 0; k < 3; ++k) {
        low[k] = widened(least[k], -1), high[k] = widened(most[k], 1);
        centroid[k] = static_cast<float>(mean[k]);
      }
      low[3] = centroid[3] = 0, high[3] = std::bit_cast<float>(index);
    }
    std::uint32_t triangle() const { return std::bit_cast<std::uint32_t>(high[3]); }
    Box box() const {
      return {Four(low.data(), stdx::vector_aligned), Four(high.data(), stdx::vector_aligned)};
    }
  };
  struct Bin {
    Box box;
    std::uint32_t count = 0;
  };
  static constexpr std::uint32_t most_bins = 32;

  [[gnu::always_inline]] static void add(Part& part, const Item& item) {
    const Four centroid(item.centroid.data(), stdx::vector_aligned);
    part.box.add(item.box()), part.centroids.add({centroid, centroid});
  }
  Part around(const Range& range) const {
    Part part{range, {}, {}};
    for (std::uint32_t k = range.begin; k < range.end; ++k) add(part, items_[k]);
    return part;
  }

  /// Cuts a part between two bins.
  void cut(const Part& part, Part& left, Part& right) {
    const Four sides = part.centroids.high - part.centroids.low;
    const std::size_t axis =
        sides[1] > sides[0] ? (sides[2] > sides[1] ? 2 : 1) : (sides[2] > sides[0] ? 2 : 0);
    const Range range = part.range;
    const std::uint32_t bins = range.size() < 128 ? most_bins / 2 : most_bins;
    const float first = part.centroids.low[axis];
    const float per_unit = static_cast<float>(bins) / sides[axis];
    // Where centroids hardly differ, or are not finite, there is nothing to choose by.
    if (!(per_unit > 0 && per_unit < std::numeric_limits<float>::infinity()))
      return halve(range, left, right);
    const auto bin_of = [=](const Item& item) {
      const float at = (item.centroid[axis] - first) * per_unit;
      return at < static_cast<float>(bins) ? static_cast<std::uint32_t>(at) : bins - 1;
    };
    std::array<Bin, most_bins> all{};
    for (std::uint32_t k = range.begin; k < range.end; ++k) {
      Bin& bin = all[bin_of(items_[k])];
      bin.box.add(items_[k].box()), ++bin.count;
    }
    const std::uint32_t end = cheapest(std::span(all).first(bins), range.size());
    if (end == 0) return halve(range, left, right);
    partition(
        range, [=](const Item& item) { return bin_of(item) < end; }, left, right);
  }

  /// The number of bins on the left of the cheapest cut; 0 where the costs are not finite.
  static std::uint32_t cheapest(std::span<const Bin> bins, std::uint32_t size) {
    std::array<float, most_bins> cost_of_right;
    Box right, left;
    std::uint32_t count = 0;
    for (std::size_t b = bins.size(); b-- > 1;) {
      right.add(bins[b].box), count += bins[b].count;
      cost_of_right[b] = right.area() * static_cast<float>(count);
    }
    float best = std::numeric_limits<float>::infinity();
    std::uint32_t end = 0;
    count = 0;
    for (std::uint32_t b = 1; b < bins.size(); ++b) {
      if (bins[b - 1].count == 0) continue;  // cut before
      left.add(bins[b - 1].box), count += bins[b - 1].count;
      if (count == size) break;
      const float cost = left.area() * static_cast<float>(count) + cost_of_right[b];
      if (cost < best) best = cost, end = b;
    }
    return end;
  }

  void halve(const Range& range, Part& left, Part& right) const {
    const std::uint32_t middle = range.begin + range.size() / 2;
    left = around({range.begin, middle}), right = around({middle, range.end});
  }

  template <class IsLeft>
  void partition(const Range& range, const IsLeft& is_left, Part& left, Part& right) {
    left = right = Part{range, {}, {}};
    std::uint32_t first = range.begin, last = range.end;
    while (true) {
      while (first < last && is_left(items_[first])) add(left, items_[first++]);
      if (first == last) break;
      --last;
      while (first < last && !is_left(items_[last])) add(right, items_[last--]);
      add(right, items_[first]);
      if (first == last) break;
      add(left, items_[last]);
      std::swap(items_[first++], items_[last]);
    }
    left.range.end = right.range.begin = first;
  }

  LargeVector<Item> items_;
};

}  // namespace bvlab
