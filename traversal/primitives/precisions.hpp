// SPDX-License-Identifier: BSD-3-Clause
/// THE list of precisions of the triangle test: how much arithmetic decides whether two triangles
/// touch, and which errors that allows. The cheaper ones err on one side only.
#pragma once

#include <string_view>

#include "hierarchies/geometry/type_list.hpp"

namespace bvlab {

struct Exact {
  static constexpr std::string_view name = "exact";
  static constexpr std::string_view description =
      "float64 filter, more digits where it cannot decide, integers for the rest: never wrong";
  using Number = double;
  static constexpr bool has_fallback = true;
};

struct Float64 {
  static constexpr std::string_view name = "float64";
  static constexpr std::string_view description =
      "float64 filter alone: pairs it cannot decide count as touching, so no contact is missed";
  using Number = double;
  static constexpr bool has_fallback = false;
};

struct Float32 {
  static constexpr std::string_view name = "float32";
  static constexpr std::string_view description =
      "corners rounded to float32, float32 throughout: pairs it cannot decide count as touching, "
      "so no contact is missed";
  using Number = float;
  static constexpr bool has_fallback = false;
};

using Precisions = TypeList<Exact, Float64, Float32>;

}  // namespace bvlab
