// SPDX-License-Identifier: BSD-3-Clause
/// Parts that stand, as clash detection has them: a building of slabs, walls, columns, pipes and
/// bolts. Each part is a mesh of its own, with vertices where it stands in the world, in metres;
/// every pose is the identity.
///
/// - Bays of 4 x 4 x 3 m fill a block of about equal numbers along x, y and z. A bay has a slab,
///   two walls on it that reach to the slab above, a column, two pipes that go on in the next bay,
///   and six bolts in the slab.
/// - Where two parts meet face to face they are joined in one of three ways, by turns: flush (both
///   faces are in one plane), overlapping by a millimetre, or apart by one unit in the last place.
/// - Sides are grids, and round parts prisms, of as many squares and sides as are drawn: hardly any
///   two meshes are alike.
///
/// The same options give the same bytes on one machine; round parts use sine and cosine.
#pragma once

#include <vector>

#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/scene.hpp"

namespace bvlab {

struct Parts {
  static constexpr std::string_view name = "parts";
  static constexpr std::string_view description =
      "a building of parts that stand: slabs, walls, columns, pipes, bolts; each has its own mesh";

  std::size_t objects = 1000;
  std::size_t frames = 1;
  std::string joints = "mixed";
  std::uint64_t seed = 1;

  template <class Visit>
  void visit_options(Visit&& visit) {
    visit("objects", objects, "number of bodies");
    visit("frames", frames, "number of frames, all alike");
    visit("joints", joints, "how faces meet [flush|overlap|apart|mixed]");
    visit("seed", seed, "of the random numbers");
  }

  /// Throws Unusable, naming the option, where values cannot be.
  void check() const;

  /// One mesh for each body; a scene with this member takes no others.
  std::vector<NamedMesh> own_meshes() const;

  Array<double> generate(std::span<const Extent> meshes, const TouchesAny& touches) const;
};

static_assert(Scene<Parts>);

}  // namespace bvlab
