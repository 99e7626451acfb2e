// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/coherence.hpp"

#include "hierarchies/volumes.hpp"

namespace bvlab {

CoherenceSums coherence(std::span<const TriangleMesh> meshes, const Trace& trace,
                        const Variant& variant) {
  check(variant);
  CoherenceSums result;
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    result = coherence_of<V>(meshes, trace, variant);
  });
  return result;
}

BestRebuilds best_rebuilds(std::span<const TriangleMesh> meshes, const Trace& trace,
                           const Variant& variant) {
  check(variant);
  BestRebuilds result;
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    result = best_rebuilds_of<V>(meshes, trace, variant);
  });
  return result;
}

}  // namespace bvlab
