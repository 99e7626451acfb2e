// SPDX-License-Identifier: BSD-3-Clause
/// A length of a scene, as people write it: a bare number in units of the mesh ("0.25"), or a
/// multiple of a radius that the meshes give ("1leaf", "4body").
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace bvlab {

struct Length {
  enum class Unit {
    mesh,  ///< the mesh's own
    leaf,  ///< the radius of the smallest leaf sphere over all meshes: see Extent::leaf_radius
    body,  ///< the radius of the largest body: see Extent::radius
  };
  double value = 0;
  Unit unit = Unit::mesh;

  friend bool operator==(const Length&, const Length&) = default;
};

/// Throws Unusable unless `text` is a number that is finite and not negative, then nothing, "leaf"
/// or "body"; a blank may separate them.
Length length_from(std::string_view text);

/// As `length_from` reads it.
std::string text_of(const Length& length);

}  // namespace bvlab
