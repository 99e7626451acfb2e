// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/replay.hpp"

#include <cmath>

#include "experiments/files/unusable.hpp"
#include "experiments/runner/strategy_text.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

static_assert(Volumes::size == BVLAB_VOLUMES, "volumes.hpp must hold one entry a line");

namespace {

template <class List>
void check_name(std::string_view option, std::string_view name) {
  if (!List::with(name, [](auto) {}))
    throw Unusable(std::string(option) + " " + std::string(name) + ": unknown; there are " +
                   List::names());
}

}  // namespace

void check(const Variant& variant) {
  check_name<Volumes>("--volume", variant.volume);
  check_name<Strategies>("--strategy", name_of(variant.strategy));
  check_name<Queries>("--query", variant.query);
  check_name<Precisions>("--precision", variant.precision);
  check_name<Builds>("--build", variant.build);
  if (variant.leaf_size < 1 || variant.leaf_size > 1u << 16)
    throw Unusable("--leaf-size " + std::to_string(variant.leaf_size) + ": must be 1 to 65536");
  if (!(variant.relative_error >= 0) || !std::isfinite(variant.relative_error))
    throw Unusable("--relative-error " + std::to_string(variant.relative_error) +
                   ": must be a number that is not negative");
  Strategies::with(name_of(variant.strategy),
                   [&]<class S>(std::type_identity<S>) { made_from<S>(variant.strategy); });
}

ReplayResult replay(std::span<const TriangleMesh> meshes, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options) {
  check(variant);
  // Nothing happens without frames, so bodies are not made, however many there would be.
  if (trace.frames == 0 && trace.objects > 0) return replay(meshes, Trace{}, variant, options);
  ReplayResult result;
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    result = replay_with<V>(meshes, trace, variant, options);
  });
  return result;
}

}  // namespace bvlab
