// SPDX-License-Identifier: BSD-3-Clause
/// A tree of blocks over boxes in spatial order: sixteen boxes to a leaf, sixteen nodes to a
/// parent, without pointers, since the children of node k are 16k .. 16k+15 one level down. It has
/// n/16 leaves and n/240 other blocks, about 30 bytes a box in float with the indices. It is joined
/// with itself by comparisons of sixteen nodes at once.
#pragma once

#include <vector>

#include "broadphase/structures/block.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/radix_sort.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

inline constexpr std::uint32_t no_box = 0xffffffffu;

/// Copies the boxes with these indices into a block; `no_box` leaves its lane empty.
template <class T>
inline void gather(Block<T>& block, const std::uint32_t* ids, Boxes<T> boxes) {
#ifdef __AVX512F__
  if constexpr (std::is_same_v<T, float>)
    if (boxes.size() < (1u << 28)) {
      const __m512i id = _mm512_loadu_si512(ids);
      const __mmask16 held = _mm512_cmpneq_epi32_mask(id, _mm512_set1_epi32(-1));
      const __m512i at = _mm512_mullo_epi32(id, _mm512_set1_epi32(6));
      const float* base = boxes.data()->lo;
      const __m512 far = _mm512_set1_ps(std::numeric_limits<float>::infinity());
      const __m512 back = _mm512_set1_ps(-std::numeric_limits<float>::infinity());
      for (int axis = 0; axis < 3; ++axis) {
        _mm512_store_ps(block.lo[axis], _mm512_mask_i32gather_ps(far, held, at, base + axis, 4));
        _mm512_store_ps(block.hi[axis],
                        _mm512_mask_i32gather_ps(back, held, at, base + 3 + axis, 4));
      }
      return;
    }
#endif
  for (int lane = 0; lane < block_width; ++lane)
    block.put(lane, ids[lane] == no_box ? nowhere<T>() : boxes[ids[lane]]);
}

template <class T>
class BlockTree {
 public:
  std::uint32_t leaves() const {
    return static_cast<std::uint32_t>(levels_.empty() ? 0 : levels_[0].size());
  }
  Block<T>& leaf(std::uint32_t k) { return levels_[0][k]; }
  const Block<T>& leaf(std::uint32_t k) const { return levels_[0][k]; }
  void fetch(std::uint32_t k) const {
    const char* const block = reinterpret_cast<const char*>(&levels_[0][k]);
    for (std::size_t byte = 0; byte < sizeof(Block<T>); byte += 64)
      __builtin_prefetch(block + byte);
  }
  std::uint32_t* ids(std::uint32_t leaf) { return ids_.data() + std::size_t{leaf} * block_width; }
  const std::uint32_t* ids(std::uint32_t leaf) const {
    return ids_.data() + std::size_t{leaf} * block_width;
  }

  /// The stored bounds of leaf k: they enclose its boxes, perhaps loosely.
  Box<T> leaf_bounds(std::uint32_t k) const {
    return levels_[1][k / block_width].box(k % block_width);
  }
  std::uint32_t slots() const { return static_cast<std::uint32_t>(ids_.size()); }
  void set_leaf_bounds(std::uint32_t k, const Box<T>& box) {
    levels_[1][k / block_width].put(k % block_width, box);
  }

  /// Calls visit(slot, id) for the boxes of about `count` leaves, evenly spread.
  template <class Visit>
  void sample(std::uint32_t count, Visit&& visit) const {
    const std::uint32_t stride = std::max<std::uint32_t>(1, leaves() / count);
    for (std::uint32_t k = 0; k < leaves(); k += stride)
      for (std::uint32_t slot = k * block_width; slot < (k + 1) * block_width; ++slot)
        if (ids_[slot] != no_box) visit(slot, ids_[slot]);
  }

  /// Mean extent of a leaf along an axis. Leaves as large as the range of floats do not count: they
  /// have boxes that stand for bodies outside the scene (NearPairs).
  double mean_leaf_extent() const {
    constexpr double huge = double{std::numeric_limits<float>::max()} * 0x1p-20;
    double sum = 0;
    std::uint32_t count = 0;
    for (std::uint32_t k = 0; k < leaves(); ++k) {
      const Box<T> box = leaf_bounds(k);
      double of_leaf = 0;
      for (int axis = 0; axis < 3; ++axis)
        of_leaf += static_cast<double>(box.hi[axis]) - static_cast<double>(box.lo[axis]);
      if (of_leaf < huge) sum += of_leaf, ++count;
    }
    return count ? sum / (3.0 * count) : 0;
  }

  /// Enlarges the box in this slot, sixteen to a leaf, and its bounds on every level above, to
  /// enclose `box`.
  void widen(std::uint32_t slot, const Box<T>& box) {
    std::size_t node = slot;
    for (std::size_t level = 0; level < depth_; ++level, node /= block_width) {
      Block<T>& block = levels_[level][node / block_width];
      const int lane = static_cast<int>(node % block_width);
      block.put(lane, enclosing(block.box(lane), box));
    }
  }

  /// Enlarges the bounds of this leaf, and on every level above, to enclose `box`.
  void widen_above(std::uint32_t leaf, const Box<T>& box) {
    std::size_t node = leaf;
    for (std::size_t level = 1; level < depth_; ++level, node /= block_width) {
      Block<T>& block = levels_[level][node / block_width];
      const int lane = static_cast<int>(node % block_width);
      const Box<T> before = block.box(lane), after = enclosing(before, box);
      if (after == before) return;
      block.put(lane, after);
    }
  }

  /// Recomputes the bounds of these leaves, given in ascending order, and of their ancestors.
  /// Clears the list.
  void refit(std::vector<std::uint32_t>& nodes) {
    for (std::size_t level = 1; level < depth_; ++level) {
      std::size_t parents = 0;
      for (const std::uint32_t node : nodes) {
        const std::uint32_t parent = node / block_width;
        levels_[level][parent].put(static_cast<int>(node % block_width),
                                   bounds(levels_[level - 1][node]));
        if (parents == 0 || nodes[parents - 1] != parent) nodes[parents++] = parent;
      }
      nodes.resize(parents);
    }
    nodes.clear();
  }

  /// Fills the leaves with the boxes in this order, then fits the levels above.
  void build(std::span<const Keyed<std::uint32_t>> order, Boxes<T> boxes, Threads& threads) {
    resize_levels((order.size() + block_width - 1) / block_width);
    std::fill(ids_.begin() + static_cast<std::ptrdiff_t>(order.size()), ids_.end(), no_box);
    // Whole blocks of leaves, so that no two threads write to the same bounds.
    constexpr std::uint32_t stretch = 16 * block_width;
    threads.share((leaves() + stretch - 1) / stretch, [&](std::size_t part, std::size_t) {
      const auto first = static_cast<std::uint32_t>(part) * stretch;
      const std::uint32_t last = std::min(first + stretch, leaves());
      for (std::size_t k = std::size_t{first} * block_width;
           k < std::min(std::size_t{last} * block_width, order.size()); ++k)
        ids_[k] = order[k].id;
      for (std::uint32_t k = first; k < last; ++k) {
        gather(leaf(k), ids(k), boxes);
        set_leaf_bounds(k, bounds(leaf(k)));
      }
    });
    refit_above();
  }

  /// Adds empty leaves for `count` boxes; returns the first of their slots.
  std::uint32_t add_slots(std::size_t count) {
    const std::uint32_t first = slots();
    resize_leaves(leaves() + static_cast<std::uint32_t>((count + block_width - 1) / block_width));
    refit_above();
    return first;
  }

  /// Sets the number of leaves; new ones are empty.
  void resize_leaves(std::uint32_t count) {
    const std::size_t had = leaves();
    resize_levels(count);
    for (std::size_t k = had; k < count; ++k) levels_[0][k] = empty_block();
    std::fill(
        ids_.begin() + static_cast<std::ptrdiff_t>(std::min(had, std::size_t{count}) * block_width),
        ids_.end(), no_box);
  }

  /// Refits every level above the leaves' bounds.
  void refit_above() {
    for (std::size_t level = 2; level < depth_; ++level)
      for (std::size_t k = 0; k < levels_[level - 1].size(); ++k)
        levels_[level][k / block_width].put(static_cast<int>(k % block_width),
                                            bounds(levels_[level - 1][k]));
  }

  /// Recomputes all bounds.
  void refit_all() {
    for (std::uint32_t k = 0; k < leaves(); ++k) set_leaf_bounds(k, bounds(leaf(k)));
    refit_above();
  }

  /// Calls visit(a, first, lanes) for leaves a whose bounds overlap those of leaf `first` + lane
  /// for every lane of `lanes`. Only a itself and later leaves are given, so each pair comes once.
  template <class Visit>
  void join(Visit&& visit) const {
    if (leaves() > 0) join_self(depth_ - 1, 0, visit);
  }

  /// Two blocks of leaves whose bounds overlap, or one with itself.
  struct Part {
    std::uint32_t a, b;
  };
  /// The parts of the join, in its order.
  void join_parts(std::vector<Part>& parts) const {
    parts.clear();
    const auto add = [&](std::uint32_t a, std::uint32_t first, LaneMask lanes) {
      for (; lanes; lanes &= lanes - 1) parts.push_back({a, first + std::countr_zero(lanes)});
    };
    if (leaves() > 0) join_self<1>(depth_ - 1, 0, add);
  }
  template <class Visit>
  void join(const Part& part, Visit&& visit) const {
    if (part.a == part.b)
      join_self(1, part.a, visit);
    else
      join_two(1, part.a, part.b, visit);
  }

  /// Calls visit(k) for every leaf whose bounds overlap `box`.
  template <class Visit>
  void find(const Box<T>& box, Visit&& visit) const {
    if (leaves() > 0) find_below(depth_ - 1, 0, box, visit);
  }

  /// The result of a batched query: pairs of a leaf and a box whose bounds overlap.
  struct Finds {
    std::vector<std::uint32_t> leaves, boxes;  ///< of each pair, ordered by box; `count` of them
    std::size_t count = 0;
    std::vector<std::uint32_t> spare_leaves, spare_boxes;
  };
  /// The leaves whose bounds overlap each of these boxes. All boxes descend one level before the
  /// next: this makes long loops, where a loop per box would end in a mispredicted branch.
  void find(std::span<const Box<T>> boxes, Finds& finds) const {
    finds.count = leaves() > 0 ? boxes.size() : 0;
    finds.leaves.resize(std::max(finds.leaves.size(), finds.count));
    finds.boxes.resize(finds.leaves.size());
    for (std::uint32_t k = 0; k < finds.count; ++k) finds.leaves[k] = 0, finds.boxes[k] = k;
    for (std::size_t level = depth_ - 1; level > 0 && finds.count > 0; --level) {
      std::size_t count = 0;
      for (std::size_t k = 0; k < finds.count; ++k) {
        if (count + block_width > finds.spare_leaves.size()) {
          finds.spare_leaves.resize(2 * count + 16 * block_width);
          finds.spare_boxes.resize(finds.spare_leaves.size());
        }
        const std::uint32_t node = finds.leaves[k], box = finds.boxes[k];
        count += write_lanes(finds.spare_leaves.data() + count, finds.spare_boxes.data() + count,
                             node * block_width, box,
                             overlapping_lanes<Closed>(levels_[level][node], boxes[box]));
      }
      std::swap(finds.leaves, finds.spare_leaves), std::swap(finds.boxes, finds.spare_boxes);
      finds.count = count;
    }
  }

 private:
  static std::size_t blocks_over(std::size_t nodes) {
    return (nodes + block_width - 1) / block_width;
  }
  std::size_t children_of_last(std::size_t level) const {
    return levels_[level - 1].size() - (levels_[level].size() - 1) * block_width;
  }
  static Block<T> empty_block() {
    Block<T> empty;
    for (int lane = 0; lane < block_width; ++lane) empty.put(lane, nowhere<T>());
    return empty;
  }

  /// New leaves and their ids are uninitialised; new blocks above them are empty.
  void resize_levels(std::size_t count) {
    std::size_t depth = 2;
    for (std::size_t nodes = blocks_over(count); nodes > 1; nodes = blocks_over(nodes)) ++depth;
    if (levels_.size() < depth) levels_.resize(depth);
    depth_ = depth;
    levels_[0].resize(count);
    std::size_t nodes = blocks_over(count);
    for (std::size_t level = 1; level < depth; ++level, nodes = blocks_over(nodes)) {
      const std::size_t had = levels_[level].size();
      levels_[level].resize(nodes, empty_block());
      // Lanes past the last child must overlap nothing, whatever they held before.
      if (nodes > 0 && nodes <= had)
        for (std::size_t lane = children_of_last(level); lane < block_width; ++lane)
          levels_[level].back().put(static_cast<int>(lane), nowhere<T>());
    }
    ids_.resize(count * block_width);
  }

  /// Recurses down to level kDown, whose nodes are passed to `visit`.
  template <std::size_t kDown = 0, class Visit>
  void join_self(std::size_t level, std::uint32_t a, Visit& visit) const {
    if (level == kDown) return visit(a, a, LaneMask{1});
    const Block<T>& block = levels_[level][a];
    const std::uint32_t first = a * block_width;
    const auto count = static_cast<std::uint32_t>(
        std::min<std::size_t>(block_width, levels_[level - 1].size() - first));
    for (std::uint32_t k = 0; k < count; ++k) {
      const LaneMask others = overlapping_lanes<Closed>(block, block.box(static_cast<int>(k)));
      if (level == kDown + 1) {
        visit(first + k, first, (others | LaneMask{1} << k) & (all_lanes << k));
        continue;
      }
      join_self<kDown>(level - 1, first + k, visit);
      for (LaneMask later = others & (all_lanes << (k + 1)); later; later &= later - 1)
        join_two<kDown>(level - 1, first + k, first + std::countr_zero(later), visit);
    }
  }

  template <std::size_t kDown = 0, class Visit>
  void join_two(std::size_t level, std::uint32_t a, std::uint32_t b, Visit& visit) const {
    if (level == kDown) return visit(a, b, LaneMask{1});
    const Block<T>& left = levels_[level][a];
    const Block<T>& right = levels_[level][b];
    LaneMask rows =
        overlapping_lanes<Closed>(left, levels_[level + 1][b / block_width].box(b % block_width));
    for (; rows; rows &= rows - 1) {
      const int row = std::countr_zero(rows);
      const std::uint32_t from = a * block_width + row, first = b * block_width;
      LaneMask others = overlapping_lanes<Closed>(right, left.box(row));
      if (level == kDown + 1)
        visit(from, first, others);
      else
        for (; others; others &= others - 1)
          join_two<kDown>(level - 1, from, first + std::countr_zero(others), visit);
    }
  }

  template <class Visit>
  void find_below(std::size_t level, std::uint32_t node, const Box<T>& box, Visit& visit) const {
    LaneMask found = overlapping_lanes<Closed>(levels_[level][node], box);
    for (; found; found &= found - 1) {
      const std::uint32_t child = node * block_width + std::countr_zero(found);
      if (level == 1)
        visit(child);
      else
        find_below(level - 1, child, box, visit);
    }
  }

  std::vector<LargeVector<Block<T>>>
      levels_;  ///< [0] the leaves; the one at depth_ - 1 has one block
  std::size_t depth_ = 0;
  LargeVector<std::uint32_t> ids_;  ///< sixteen to a leaf
};

}  // namespace bvlab
