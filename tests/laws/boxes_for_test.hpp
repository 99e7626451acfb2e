// SPDX-License-Identifier: BSD-3-Clause
/// Frames of boxes that broad phases get wrong: touching, flat, equal, nested, far out, far apart
/// in size.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "broadphase/box.hpp"

namespace bvlab {

template <class T>
using Frame = std::vector<Box<T>>;

/// The pairs in order, found by definition.
template <class Contact, class T>
std::vector<Pair> pairs_by_definition(const Frame<T>& boxes) {
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
      if (overlap<Contact>(boxes[i], boxes[j])) pairs.push_back({i, j});
  return pairs;
}

inline std::vector<Pair> sorted(std::span<const Pair> pairs) {
  std::vector<Pair> copy(pairs.begin(), pairs.end());
  std::sort(copy.begin(), copy.end());
  return copy;
}

template <class T>
struct BoxCase {
  std::string name;
  Frame<T> boxes;
};

template <class T>
class BoxMaker {
 public:
  explicit BoxMaker(unsigned seed) : random_(seed) {}

  T uniform(T lo, T hi) { return std::uniform_real_distribution<T>(lo, hi)(random_); }
  unsigned below(unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random_); }

  Box<T> box(T low, T high, T least, T most) {
    Box<T> b;
    for (int axis = 0; axis < 3; ++axis) {
      b.lo[axis] = uniform(low, high);
      b.hi[axis] = b.lo[axis] + uniform(least, most);
    }
    return b;
  }
  Frame<T> boxes(int n, T low, T high, T least, T most) {
    Frame<T> frame;
    for (int k = 0; k < n; ++k) frame.push_back(box(low, high, least, most));
    return frame;
  }

  std::vector<BoxCase<T>> cases(int n) {
    std::vector<BoxCase<T>> all;
    const auto add = [&](std::string name, Frame<T> boxes) {
      all.push_back({std::move(name), std::move(boxes)});
    };
    add("none", {});
    add("one", boxes(1, 0, 1, 0, 1));
    add("two", boxes(2, 0, 1, 0, 1));
    add("seventeen", boxes(17, 0, 1, 0, T(0.5)));
    add("sparse", boxes(n, 0, 1, T(0.01), T(0.05)));
    add("dense", boxes(n, 0, 1, T(0.1), T(0.4)));
    add("points", boxes(n, 0, 1, 0, 0));
    add("far out", boxes(n, T(1e6), T(1e6) + 1, T(0.01), T(0.2)));
    Frame<T> grid, lattice, equal(n, box(0, 1, 0, 1)), stacked, sizes, flat, nested, outlier,
        clumps, huge;
    for (int k = 0; k < n; ++k) {
      const T x = static_cast<T>(k % 7), y = static_cast<T>(k / 7 % 7), z = static_cast<T>(k / 49);
      grid.push_back({{x, y, z}, {x + 1, y + 1, z + 1}});
      Box<T> b;  // integer corners: ties on every axis, zero extents among them
      for (int axis = 0; axis < 3; ++axis) {
        b.lo[axis] = static_cast<T>(below(6)) - 3;
        b.hi[axis] = b.lo[axis] + static_cast<T>(below(3));
      }
      lattice.push_back(b);
      stacked.push_back({{T(0), T(0), static_cast<T>(k)}, {T(1), T(1), static_cast<T>(k) + 1}});
      const T size = std::pow(T(10), uniform(-6, 0));
      sizes.push_back(box(0, 1, size / 2, size));
      Box<T> f = box(0, 1, T(0.05), T(0.3));
      f.hi[k % 3] = f.lo[k % 3] = static_cast<T>(below(4)) / 4;
      flat.push_back(f);
      nested.push_back(k == 0 ? Box<T>{{-1, -1, -1}, {3, 3, 3}} : box(0, 1, T(0.01), T(0.05)));
      outlier.push_back(k == n / 2
                            ? Box<T>{{T(1e6), T(1e6), T(1e6)}, {T(1e6), T(1e6) + 1, T(1e6) + 2}}
                            : box(0, 1, T(0.01), T(0.05)));
      const T centre = std::pow(T(10), static_cast<T>(k % 5));
      clumps.push_back(box(centre, centre + T(0.01), T(1e-4), T(2e-3)));
      constexpr T limit = std::numeric_limits<T>::max();
      huge.push_back(k % 3 ? box(-limit / 2, limit / 4, 0, limit / 4)
                           : Box<T>{{-limit, -limit, -limit}, {limit, limit, limit}});
    }
    add("grid", std::move(grid));
    add("lattice", std::move(lattice));
    add("equal", std::move(equal));
    add("stacked", std::move(stacked));
    add("sizes over six decades", std::move(sizes));
    add("flat", std::move(flat));
    add("one contains all", std::move(nested));
    add("one far away", std::move(outlier));
    add("clumps", std::move(clumps));
    add("up to the largest number", std::move(huge));
    return all;
  }

 private:
  std::mt19937 random_;
};

}  // namespace bvlab
