// SPDX-License-Identifier: BSD-3-Clause
/// A mesh's triangles in an array whose ranges are split on request, by the surface-area heuristic
/// (goldsmith1987automatic, wald2007fast), so that a tree can be made where somebody looks. A split
/// reads its range alone: ranges that do not overlap can be split by different threads, in any
/// order, and the tree is always the same. O(n log F) for one of n triangles into F parts, about 10
/// ns a triangle for each factor of two.
///
/// Triangles are known by their boxes in float, rounded outwards. A part's box is the union of its
/// triangles' boxes. Of a range's parts that with the largest box is split next (wald2008getting),
/// between two of 32 bins of centres along the axis where that costs least. Of a large range some
/// thousand triangles decide the cut: all of them would take twice the time and gain nothing.
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
#include "hierarchies/geometry/threads.hpp"
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
  /// A range, the box around its triangles, and that around twice the centres of their boxes.
  struct Part {
    Range range;
    Box box, centres;
    float priority = -1;  ///< of being split; negative where it is not to be
  };
  static constexpr std::uint32_t most_parts = 16;
  /// Of larger ranges a sample decides where they are split.
  static constexpr std::uint32_t sampled = 1024;
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
  /// further. Does not throw. A range of at most `sampled` triangles that has been split already is
  /// split into the same parts, which remain as they are.
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

  /// The binary tree, made to its end, level by level. It does not depend on the number of threads.
  Topology binary(std::uint32_t leaf_size, Threads& threads) {
    Topology topology;
    topology.nodes.resize(1);
    leaf_size = std::max(leaf_size, 1u);
    std::vector<Range> ranges{all()};
    std::vector<Parts> parts(threads.count());
    for (std::size_t begin = 0, end; (end = ranges.size()) > begin; begin = end) {
      for (std::size_t i = begin; i < end; ++i) {
        const bool leaf = ranges[i].size() <= leaf_size;
        topology.nodes[i] = {leaf ? ranges[i].begin : static_cast<std::uint32_t>(ranges.size()),
                             leaf ? ranges[i].size() : 0};
        if (!leaf) ranges.resize(ranges.size() + 2), topology.nodes.resize(ranges.size());
      }
      threads.share(end - begin, [&](std::size_t k, std::size_t worker) {
        const Topology::Node& node = topology.nodes[begin + k];
        if (node.count > 0) return;
        split(ranges[begin + k], 2, leaf_size, parts[worker]);
        for (std::uint32_t part = 0; part < 2; ++part)
          ranges[node.first + part] = parts[worker][part].range;
      });
    }
    for (std::uint32_t k = 0; k < items_.size(); ++k) topology.primitives.push_back(triangle(k));
    return topology;
  }

 private:
  /// The box of a triangle, and in the fourth number of `high` its index in the mesh.
  struct alignas(16) Item {
    std::array<float, 4> low, high;

    void put(const Triangle& t, std::uint32_t index) {
      const Vec3<double> least = t[0].cwiseMin(t[1]).cwiseMin(t[2]),
                         most = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
      const auto widened = [](double x, float by) {
        const auto y = static_cast<float>(x);
        return y + by * (std::abs(y) * (8 * unit_roundoff<float>)+4 *
                         std::numeric_limits<float>::denorm_min());
      };
      for (int k = 0; k < 3; ++k) low[k] = widened(least[k], -1), high[k] = widened(most[k], 1);
      low[3] = 0, high[3] = std::bit_cast<float>(index);
    }
    std::uint32_t triangle() const { return std::bit_cast<std::uint32_t>(high[3]); }
    Box box() const {
      return {Four(low.data(), stdx::vector_aligned), Four(high.data(), stdx::vector_aligned)};
    }
  };
  /// Some triangles: the box around them, and their number.
  struct Bin {
    Box box;
    std::uint32_t count = 0;

    [[gnu::always_inline]] void add(const Bin& other) { box.add(other.box), count += other.count; }
    float cost() const { return box.area() * static_cast<float>(count); }
  };
  static constexpr std::uint32_t most_bins = 32, few = 8;

  [[gnu::always_inline]] static void add(Part& part, const Item& item) {
    const Box box = item.box();
    const Four centre = box.low + box.high;
    part.box.add(box), part.centres.add({centre, centre});
  }
  Part around(const Range& range) const {
    Part part{range, {}, {}};
    for (std::uint32_t k = range.begin; k < range.end; ++k) add(part, items_[k]);
    return part;
  }

  /// A cut along an axis: what lies below `at` goes to the left. And its cost.
  struct Cut {
    std::size_t axis = 0;
    float at = 0, cost = std::numeric_limits<float>::infinity();

    static float key(const Item& item, std::size_t axis) {
      return item.low[axis] + item.high[axis];
    }
    bool is_left(const Item& item) const { return key(item, axis) < at; }
  };

  /// Cuts a part where that costs least.
  void cut(const Part& part, Part& left, Part& right) {
    if (part.range.size() == 2) return halve(part.range, left, right);
    const std::uint32_t stride = 1 + (part.range.size() - 1) / sampled;
    Cut best;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (part.range.size() <= few)
        try_few(part.range, axis, best);
      else
        try_bins(part, axis, stride, best);
    partition(
        part.range, [=](const Item& item) { return best.is_left(item); }, left, right);
    if (left.range.size() == 0 || right.range.size() == 0) halve(part.range, left, right);
  }

  /// The cuts between bins along an axis, for every `stride`-th triangle.
  void try_bins(const Part& part, std::size_t axis, std::uint32_t stride, Cut& best) const {
    const Range range = part.range;
    const std::uint32_t bins = range.size() < 128 ? most_bins / 2 : most_bins;
    const float first = part.centres.low[axis],
                per_unit = static_cast<float>(bins) / (part.centres.high[axis] - first);
    // Where centres hardly differ, or are not finite, there is nothing to choose by.
    if (!(per_unit > 0 && per_unit < std::numeric_limits<float>::infinity())) return;
    std::array<Bin, most_bins> all;
    std::fill_n(all.begin(), bins, Bin());
    for (std::uint32_t k = range.begin; k < range.end; k += stride) {
      const float at = (Cut::key(items_[k], axis) - first) * per_unit;
      Bin& bin = all[at < static_cast<float>(bins) ? static_cast<std::uint32_t>(at) : bins - 1];
      bin.box.add(items_[k].box()), ++bin.count;
    }
    std::array<float, most_bins> cost_of_right;
    Bin right, left;
    for (std::uint32_t b = bins; b-- > 1;) right.add(all[b]), cost_of_right[b] = right.cost();
    const std::uint32_t size = right.count + all[0].count;
    for (std::uint32_t b = 1; b < bins; ++b) {
      if (all[b - 1].count == 0) continue;  // cut before
      left.add(all[b - 1]);
      if (left.count == size) break;
      if (const float cost = left.cost() + cost_of_right[b]; cost < best.cost)
        best = {axis, first + static_cast<float>(b) / per_unit, cost};
    }
  }
  /// All cuts along an axis, of a few triangles: faster than bins.
  void try_few(const Range& range, std::size_t axis, Cut& best) const {
    std::array<const Item*, few> sorted;
    const std::uint32_t size = range.size();
    for (std::uint32_t i = 0; i < size; ++i) {
      const Item& next = items_[range.begin + i];
      std::uint32_t at = i;
      for (; at > 0 && Cut::key(*sorted[at - 1], axis) > Cut::key(next, axis); --at)
        sorted[at] = sorted[at - 1];
      sorted[at] = &next;
    }
    std::array<float, few> cost_of_right;
    Bin right, left;
    for (std::uint32_t i = size; i-- > 1;)
      right.add({sorted[i]->box(), 1}), cost_of_right[i] = right.cost();
    for (std::uint32_t i = 1; i < size; ++i) {
      left.add({sorted[i - 1]->box(), 1});
      const float at = Cut::key(*sorted[i], axis), cost = left.cost() + cost_of_right[i];
      if (Cut::key(*sorted[i - 1], axis) < at && cost < best.cost) best = {axis, at, cost};
    }
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
