// SPDX-License-Identifier: BSD-3-Clause
/// HYBRID, the streamed segment tree (BibTeX: zomorodian2002fast): two boxes overlap where on every
/// axis one contains the other's lower end. The segment tree over lower ends is never stored: boxes
/// are partitioned in place during the recursion, an interval that spans a node descends to the
/// next axis, and below the cutoff boxes are scanned along x. O(n log^3 n + k) time, O(n) space;
/// but boxes whose lower ends are equal are scanned along x, in O(n^2) at worst.
/// The tree is made top down in each frame, so coherence has no effect.
#pragma once

#include <algorithm>
#include <vector>

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_list.hpp"

namespace bvlab {

template <class T, class Contact>
class Hybrid {
 public:
  using Scalar = T;
  static constexpr std::string_view name = "hybrid";
  static constexpr std::string_view description = "streamed segment tree, scanned below a cutoff";

  explicit Hybrid(const MethodSettings& settings)
      : cutoff_(std::max<std::ptrdiff_t>(settings.cutoff, 2)) {}

  std::span<const Pair> overlapping(Boxes<T> boxes) {
    pairs_.clear();
    points_.clear();
    for (std::uint32_t k = 0; k < boxes.size(); ++k) points_.push_back({boxes[k], k});
    intervals_ = points_;
    constexpr T far = std::numeric_limits<T>::infinity();
    descend(points_, intervals_, -far, far, 2);
    return pairs_.view();
  }

 private:
  struct Item {
    Box<T> box;
    std::uint32_t id;
  };
  using Items = std::span<Item>;

  /// Equal lower ends are ordered by index, so that exactly one of two boxes contains the other's.
  static bool before(const Item& a, const Item& b, int axis) {
    return a.box.lo[axis] != b.box.lo[axis] ? a.box.lo[axis] < b.box.lo[axis] : a.id < b.id;
  }
  static bool contains_low_end(const Item& interval, const Item& point, int axis) {
    return !before(point, interval, axis) && point.box.lo[axis] <= interval.box.hi[axis];
  }

  /// Finds the pairs whose interval contains the point's lower end on `axis` and that overlap on
  /// the lower axes; on higher axes they do already. Points have lower ends in [lo, hi).
  void descend(Items points, Items intervals, T lo, T hi, int axis) {
    if (points.empty() || intervals.empty()) return;
    if (axis == 0 || std::min(std::ssize(points), std::ssize(intervals)) < cutoff_)
      return scan(points, intervals, axis);
    const auto spanning = std::partition(intervals.begin(), intervals.end(), [&](const Item& i) {
      return i.box.lo[axis] < lo && i.box.hi[axis] >= hi;
    });
    if (const Items all(intervals.begin(), spanning); !all.empty()) {
      constexpr T far = std::numeric_limits<T>::infinity();
      descend(points, all, -far, far, axis - 1);
      descend(all, points, -far, far, axis - 1);
    }
    const T middle = about_median(points, axis);
    const auto split = std::partition(points.begin(), points.end(),
                                      [&](const Item& p) { return p.box.lo[axis] < middle; });
    const Items rest(spanning, intervals.end());
    if (split == points.begin() || split == points.end()) return scan(points, rest, axis);
    const auto left = std::partition(rest.begin(), rest.end(), [&](const Item& i) {
      return i.box.lo[axis] < middle && i.box.hi[axis] >= lo;
    });
    descend({points.begin(), split}, {rest.begin(), left}, lo, middle, axis);
    const auto right = std::partition(rest.begin(), rest.end(), [&](const Item& i) {
      return i.box.lo[axis] < hi && i.box.hi[axis] >= middle;
    });
    descend({split, points.end()}, {rest.begin(), right}, middle, hi, axis);
  }

  /// The median of a regular sample.
  static T about_median(Items points, int axis) {
    constexpr std::size_t most = 63;
    T sample[most];
    const std::size_t count = std::min(points.size(), most);
    for (std::size_t k = 0; k < count; ++k)
      sample[k] = points[k * points.size() / count].box.lo[axis];
    std::nth_element(sample, sample + count / 2, sample + count);
    return sample[count / 2];
  }

  void scan(Items points, Items intervals, int axis) {
    const auto sort = [](Items items) {
      std::sort(items.begin(), items.end(),
                [](const Item& a, const Item& b) { return before(a, b, 0); });
    };
    sort(points);
    sort(intervals);
    auto p = points.begin(), i = intervals.begin();
    while (p != points.end() && i != intervals.end())
      if (before(*i, *p, 0)) {
        for (auto q = p; q != points.end() && q->box.lo[0] <= i->box.hi[0]; ++q)
          report(*q, *i, axis);
        ++i;
      } else if (p->id == i->id) {
        // The same box as point and as interval: pair it with the boxes that start later.
        for (auto q = p; q != points.end() && q->box.lo[0] <= i->box.hi[0]; ++q)
          report(*q, *i, axis);
        ++i;
      } else {
        if (axis > 0)
          for (auto j = i; j != intervals.end() && j->box.lo[0] <= p->box.hi[0]; ++j)
            report(*p, *j, axis);
        ++p;
      }
  }

  /// Reports the pair if it overlaps on the axes below `axis`; on x it does already.
  void report(const Item& point, const Item& interval, int axis) {
    if (point.id == interval.id) return;
    for (int below = 1; below < axis; ++below)
      if (point.box.lo[below] > interval.box.hi[below] ||
          interval.box.lo[below] > point.box.hi[below])
        return;
    if (!contains_low_end(interval, point, axis)) return;
    if (!std::is_same_v<Contact, Closed> && !overlap<Contact>(point.box, interval.box)) return;
    pairs_.push(ordered(point.id, interval.id));
  }

  std::ptrdiff_t cutoff_;
  std::vector<Item> points_, intervals_;
  PairList pairs_;
};

}  // namespace bvlab
