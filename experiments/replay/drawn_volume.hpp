// SPDX-License-Identifier: BSD-3-Clause
/// A volume as the numbers that whoever draws it needs, in its mesh's frame. A volume is known by
/// its members, so that one outside the list is drawn too where it is of a shape that is known.
#pragma once

#include <string_view>
#include <vector>

#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

namespace detail {

template <class... Part>
std::vector<float> numbers_of(const Part&... parts) {
  std::vector<float> numbers;
  const auto add = [&](const auto& part) {
    if constexpr (requires { part.size(); })
      for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(part.size()); ++i)
        numbers.push_back(static_cast<float>(part[i]));
    else
      numbers.push_back(static_cast<float>(part));
  };
  (add(parts), ...);
  return numbers;
}

}  // namespace detail

/// Whether V holds this number of scalars and nothing else: a capsule has a centre and a radius,
/// too.
template <class V>
constexpr bool holds(std::size_t scalars) {
  return sizeof(V) == scalars * sizeof(typename V::scalar);
}

/// What is drawn, "" where it is nothing known; its numbers stand in the order of `drawn_numbers`.
template <class V>
constexpr std::string_view drawn_as() {
  if (requires(V v) { v.bounds; }) return "k-dop";
  if (requires(V v) { v.centre, v.axes, v.half; } && holds<V>(15)) return "box";
  if (requires(V v) { v.centre, v.side, v.half, v.radius; } && holds<V>(12)) return "rectangle";
  if (requires(V v) { v.centre, v.half, v.normal, v.slab_centre, v.width; } && holds<V>(11))
    return "slab-box";
  if (requires(V v) { v.centre, v.axis, v.inner, v.outer, v.cosine; } && holds<V>(9))
    return "shell";
  if (requires(V v) { v.centre, v.radius; } && holds<V>(4)) return "ball";
  return "";
}

template <class V>
std::vector<float> drawn_numbers(const V& v) {
  using detail::numbers_of;
  if constexpr (drawn_as<V>() == "k-dop")
    return numbers_of(v.bounds);
  else if constexpr (drawn_as<V>() == "box")
    return numbers_of(v.centre, v.axes[0], v.axes[1], v.axes[2], v.half);
  else if constexpr (drawn_as<V>() == "rectangle")
    return numbers_of(v.centre, v.side[0], v.side[1], v.half, v.radius);
  else if constexpr (drawn_as<V>() == "slab-box")
    return numbers_of(v.centre, v.half, v.normal, v.slab_centre, v.width);
  else if constexpr (drawn_as<V>() == "shell")
    return numbers_of(v.centre, v.axis, v.inner, v.outer, v.cosine);
  else if constexpr (drawn_as<V>() == "ball")
    return numbers_of(v.centre, v.radius);
  else
    return {};
}

}  // namespace bvlab
