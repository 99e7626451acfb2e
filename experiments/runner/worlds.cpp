// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/worlds.hpp"

#include "hierarchies/volumes.hpp"

namespace bvlab {

std::unique_ptr<WorldEngine> make_world(std::span<const TriangleMesh> meshes, std::size_t objects,
                                        const Variant& variant) {
  check(variant);
  std::unique_ptr<WorldEngine> world;
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    world = make_world_of<V>(meshes, objects, variant);
  });
  return world;
}

}  // namespace bvlab
