// SPDX-License-Identifier: BSD-3-Clause
/// A spatial order of boxes, in which neighbours in the list are near in space and alike in size:
/// by class (size within a factor of eight, elongation), and within a class along a Morton curve of
/// the centres. A run of more than 32 centres in one Morton cell is sorted again within its own
/// bounds, so that one far box, or clusters within clusters, cost only that run. The first sort
/// is a radix sort, O(n); a run of m boxes is sorted by comparison on one thread, O(m log m).
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "broadphase/structures/block.hpp"
#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/radix_sort.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

template <class T>
class SpatialOrder {
 public:
  using Item = Keyed<std::uint32_t>;

  /// The boxes' indices in spatial order, as the `id` of each item; valid until the next call.
  std::span<const Item> operator()(Boxes<T> boxes, Threads& threads) {
    items_.resize(boxes.size());
    if (boxes.empty()) return {};
    const Summary all = summary(boxes, threads);
    classify(boxes, all, threads);
    const int class_bits = std::bit_width(classes_ - 1u);
    // A hundred cells per box: few boxes share a cell, and those that do are refined.
    const int enough = (std::bit_width(boxes.size()) + 7 + 2) / 3;
    const int digits = std::min({10, (32 - class_bits) / 3, enough});
    make_keys(boxes, Cells(all, digits), threads);
    radix_sort(items_, spare_, std::max(1, 3 * digits + class_bits), threads);
    refine(boxes);
    return items_;
  }

  std::span<const Item> operator()(Boxes<T> boxes) {
    Threads alone;
    return (*this)(boxes, alone);
  }

  std::uint32_t classes() const { return classes_; }

 private:
  static constexpr std::size_t crowd =
      2 * block_width;  ///< a run of more equal keys than this is refined

  /// The bounds of the centres (stored as (lo + hi) / 4, so that no difference overflows), and the
  /// smallest and largest extent on any axis.
  struct Summary {
    T lo[3], hi[3], least, most;
  };
  struct Tally {
    T lo[3][block_width], hi[3][block_width], least[block_width], most[block_width];
    Tally() {
      constexpr T far = std::numeric_limits<T>::infinity();
      std::fill_n(&lo[0][0], 3 * block_width, far), std::fill_n(&hi[0][0], 3 * block_width, -far);
      std::fill_n(least, block_width, far), std::fill_n(most, block_width, -far);
    }
    void add(const Block<T>& block) {
      for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < block_width; ++k) {
          const T centre = T(0.25) * block.lo[axis][k] + T(0.25) * block.hi[axis][k];
          const T extent = block.hi[axis][k] - block.lo[axis][k];
          lo[axis][k] = centre < lo[axis][k] ? centre : lo[axis][k];
          hi[axis][k] = centre > hi[axis][k] ? centre : hi[axis][k];
          least[k] = extent < least[k] ? extent : least[k];
          most[k] = extent > most[k] ? extent : most[k];
        }
    }
    Summary sum() const {
      Summary all;
      for (int axis = 0; axis < 3; ++axis) {
        all.lo[axis] = *std::min_element(lo[axis], lo[axis] + block_width);
        all.hi[axis] = *std::max_element(hi[axis], hi[axis] + block_width);
      }
      all.least = *std::min_element(least, least + block_width);
      all.most = *std::max_element(most, most + block_width);
      return all;
    }
  };

  /// Calls visit(block, first, count) for each sixteen boxes of the frame from `begin` to `end`;
  /// `begin` is a multiple of sixteen; lanes after the last box repeat it.
  template <class Visit>
  static void for_blocks(Boxes<T> boxes, std::size_t begin, std::size_t end, Visit&& visit) {
    Block<T> block;
    std::size_t first = begin;
    for (; first + block_width <= end; first += block_width) {
      load(block, boxes.data() + first);
      visit(block, first, std::size_t{block_width});
    }
    if (first == end) return;
    for (int lane = 0; lane < block_width; ++lane)
      block.put(lane, boxes[std::min(first + lane, end - 1)]);
    visit(block, first, end - first);
  }

  static constexpr std::size_t stretch = 4096;  ///< boxes in a range of for_stretches
  /// Calls work(begin, end, worker) for ranges of the boxes, on all threads.
  template <class Work>
  static void for_stretches(Boxes<T> boxes, Threads& threads, const Work& work) {
    threads.share((boxes.size() + stretch - 1) / stretch,
                  [&](std::size_t part, std::size_t worker) {
                    work(part * stretch, std::min((part + 1) * stretch, boxes.size()), worker);
                  });
  }

  Summary summary(Boxes<T> boxes, Threads& threads) {
    tallies_.assign(threads.count(), Tally());
    for_stretches(boxes, threads, [&](std::size_t begin, std::size_t end, std::size_t worker) {
      // A local copy, so that no two threads write to one cache line.
      Tally tally = tallies_[worker];
      for_blocks(boxes, begin, end,
                 [&](const Block<T>& block, std::size_t, std::size_t) { tally.add(block); });
      tallies_[worker] = tally;
    });
    Summary all = tallies_[0].sum();
    for (std::size_t k = 1; k < tallies_.size(); ++k) {
      const Summary other = tallies_[k].sum();
      for (int axis = 0; axis < 3; ++axis) {
        all.lo[axis] = std::min(all.lo[axis], other.lo[axis]);
        all.hi[axis] = std::max(all.hi[axis], other.hi[axis]);
      }
      all.least = std::min(all.least, other.least), all.most = std::max(all.most, other.most);
    }
    return all;
  }

  /// Finds and numbers the classes in use; one where all boxes are alike. Boxes smaller than the
  /// mean distance of neighbours share a class: their size does not widen a leaf.
  void classify(Boxes<T> boxes, const Summary& all, Threads& threads) {
    classes_ = 1;
    if (all.most <= 8 * all.least) return;
    const int small = exponent(spacing(all, boxes.size()));
    kinds_.resize(boxes.size());
    seen_.assign(threads.count(), {});
    for_stretches(boxes, threads, [&](std::size_t begin, std::size_t end, std::size_t worker) {
      for (std::size_t k = begin; k < end; ++k) {
        kinds_[k] = static_cast<std::uint16_t>(kind(boxes[k], small));
        seen_[worker][kinds_[k]] = 1;
      }
    });
    auto& used = seen_[0];
    for (const auto& other : seen_)
      for (std::size_t k = 0; k < used.size(); ++k) used[k] |= other[k];
    // From the largest size down, each class spans three powers of two.
    classes_ = 0;
    for (int top = exponents - 1; top >= 0; --top) {
      bool any = false;
      for (int shape = 0; shape < shapes; ++shape) any |= used[top * shapes + shape];
      if (!any) continue;
      const int bottom = std::max(0, top - 2);
      for (int shape = 0; shape < shapes; ++shape) {
        bool present = false;
        for (int e = bottom; e <= top; ++e) present |= used[e * shapes + shape];
        for (int e = bottom; e <= top; ++e) class_of_[e * shapes + shape] = classes_;
        classes_ += present;
      }
      top = bottom;
    }
  }
  /// The distance between neighbours if the centres were spread evenly over their bounds.
  static double spacing(const Summary& all, std::size_t count) {
    double log_volume = 0;
    int spread = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double width =
          2 * (static_cast<double>(all.hi[axis]) - static_cast<double>(all.lo[axis]));
      if (width > 0) log_volume += std::log(width), ++spread;
    }
    return spread ? std::exp((log_volume - std::log(static_cast<double>(count))) / spread) : 0;
  }

  static constexpr int exponents = 256;
  static constexpr int shapes = 7;
  static int exponent(double size) {
    return static_cast<int>(std::bit_cast<std::uint32_t>(static_cast<float>(size)) >> 23);
  }
  /// The size's binary exponent (at least `small`) times `shapes`; for larger boxes plus a shape:
  /// the axis that is over four times longer (1, 2, 3) or shorter (4, 5, 6) than the next.
  static int kind(const Box<T>& box, int small) {
    const T x = box.hi[0] - box.lo[0], y = box.hi[1] - box.lo[1], z = box.hi[2] - box.lo[2];
    const T size = std::max(x, std::max(y, z));
    const int e = exponent(static_cast<double>(size));
    if (e <= small) return small * shapes;
    const T least = std::min(x, std::min(y, z));
    const T middle = std::max(std::min(x, y), std::min(std::max(x, y), z));
    int shape = 0;
    if (size > 4 * middle)
      shape = size == x ? 1 : size == y ? 2 : 3;
    else if (middle > 4 * least)
      shape = least == x ? 4 : least == y ? 5 : 6;
    return e * shapes + shape;
  }
  /// Stretches cells as boxes are: on an axis on which boxes are long, neighbours are farther
  /// apart, by a factor of four.
  static std::uint32_t stretched(std::uint32_t key, int shape) {
    static constexpr std::uint32_t x = 0x09249249u, y = x << 1, z = x << 2;
    static constexpr std::uint32_t long_axes[shapes] = {0, x, y, z, y | z, x | z, x | y};
    const std::uint32_t axes = long_axes[shape];
    return (key & ~axes) | ((key & axes) >> 6);
  }

  static std::uint32_t spread(std::uint32_t x) {  // ten bits, two zeros between each
    x = (x | (x << 16)) & 0x030000ffu;
    x = (x | (x << 8)) & 0x0300f00fu;
    x = (x | (x << 4)) & 0x030c30c3u;
    return (x | (x << 2)) & 0x09249249u;
  }

  /// A grid of 2^digits cells a side over the centres. Cells are cubes, so that a flat scene spends
  /// no bits on its thin axis.
  struct Cells {
    T low[3], scale, last;
    int digits;
    Cells(const Summary& all, int digits) : digits(digits) {
      T width = 0;
      for (int axis = 0; axis < 3; ++axis)
        low[axis] = all.lo[axis], width = std::max(width, all.hi[axis] - all.lo[axis]);
      scale = static_cast<T>(1 << digits) / width;
      if (!std::isfinite(scale)) scale = 0;
      last = static_cast<T>((1 << digits) - 1);
    }
    void keys(const Block<T>& block, std::uint32_t* key) const {
      std::uint32_t sum[block_width] = {};
      for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < block_width; ++k) {
          const T centre = T(0.25) * block.lo[axis][k] + T(0.25) * block.hi[axis][k];
          const T cell = (centre - low[axis]) * scale;
          sum[k] |= spread(static_cast<std::uint32_t>(
                        static_cast<std::int32_t>(cell < last ? cell : last)))
                    << axis;
        }
      std::copy_n(sum, block_width, key);
    }
  };

  void make_keys(Boxes<T> boxes, const Cells& cells, Threads& threads) {
    for_stretches(boxes, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
      make_keys(boxes, begin, end, cells);
    });
  }
  void make_keys(Boxes<T> boxes, std::size_t begin, std::size_t end, const Cells& cells) {
    for_blocks(boxes, begin, end, [&](const Block<T>& block, std::size_t first, std::size_t count) {
      std::uint32_t key[block_width];
      cells.keys(block, key);
      if (classes_ > 1)
        for (std::size_t k = 0; k < count; ++k) {
          const int kind = kinds_[first + k];
          key[k] = stretched(key[k], kind % shapes) | class_of_[kind] << (3 * cells.digits);
        }
      for (std::size_t k = 0; k < count; ++k)
        items_[first + k] = {key[k], static_cast<std::uint32_t>(first + k)};
    });
  }

  /// Sorts every crowded run of equal keys again, within its own bounds.
  void refine(Boxes<T> boxes) {
    runs_.clear();
    push_runs(0, items_.size(), items_.size() + 1);
    while (!runs_.empty()) {
      const auto [first, last] = runs_.back();
      runs_.pop_back();
      const auto run = std::span(items_).subspan(first, last - first);
      order_again(boxes, run);
      std::sort(run.begin(), run.end(), [](const Item& a, const Item& b) {
        return a.key != b.key ? a.key < b.key : a.id < b.id;
      });
      push_runs(first, last, run.size());
    }
  }
  static void order_again(Boxes<T> boxes, std::span<Item> run) {
    const auto for_run = [&](auto&& visit) {
      Block<T> block;
      for (std::size_t first = 0; first < run.size(); first += block_width) {
        for (int lane = 0; lane < block_width; ++lane)
          block.put(lane, boxes[run[std::min(first + lane, run.size() - 1)].id]);
        visit(block, run.subspan(first, std::min<std::size_t>(block_width, run.size() - first)));
      }
    };
    Tally tally;
    for_run([&](const Block<T>& block, std::span<Item>) { tally.add(block); });
    const Cells cells(tally.sum(), 10);
    for_run([&](const Block<T>& block, std::span<Item> items) {
      std::uint32_t key[block_width];
      cells.keys(block, key);
      for (std::size_t k = 0; k < items.size(); ++k) items[k].key = key[k];
    });
  }
  /// Adds crowded runs shorter than `whole`; one as long holds equal centres, as it did not split.
  void push_runs(std::size_t first, std::size_t last, std::size_t whole) {
    for (std::size_t k = first; k < last;) {
      // Most runs are short: test one crowd ahead first.
      if (last - k <= crowd) return;
      if (items_[k + crowd].key != items_[k].key) {
        ++k;
        continue;
      }
      std::size_t end = k + crowd;
      while (end < last && items_[end].key == items_[k].key) ++end;
      if (end - k < whole) runs_.push_back({k, end});
      k = end;
    }
  }

  LargeVector<Item> items_, spare_;
  std::vector<std::pair<std::size_t, std::size_t>> runs_;
  std::array<std::uint32_t, exponents * shapes> class_of_{};
  std::uint32_t classes_ = 1;
  std::vector<Tally> tallies_;                                      // of each thread
  std::vector<std::array<std::uint8_t, exponents * shapes>> seen_;  // by each thread
  LargeVector<std::uint16_t> kinds_;  ///< of each box, where there are several classes
};

}  // namespace bvlab
