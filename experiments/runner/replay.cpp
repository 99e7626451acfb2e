// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/replay.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/runner/strategy_text.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

static_assert(Volumes::size == BVLAB_VOLUMES, "volumes.hpp must hold one entry a line");

void Trace::poses(std::size_t frame, std::span<Pose> poses) const {
  const double* v = values.data() + frame * objects * 7;
  for (std::size_t i = 0; i < objects; ++i, v += 7)
    poses[i] = *pose_from({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6]);
}

Trace read_trace(const std::string& path) {
  constexpr std::size_t shape[] = {any_length, any_length, 7};
  auto array = read_npy<double>(path, shape);
  Trace trace{array.shape[0], array.shape[1], std::move(array.data)};
  for (std::size_t i = 0; i < trace.values.size(); i += 7) {
    const double* v = trace.values.data() + i;
    if (pose_from({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6])) continue;
    const bool finite = std::all_of(v, v + 7, [](double x) { return std::isfinite(x); });
    const std::size_t object = i / 7 % trace.objects, frame = i / 7 / trace.objects;
    throw Unusable(path, std::string(finite ? "zero quaternion" : "not a finite number") +
                             " in frame " + std::to_string(frame) + ", object " +
                             std::to_string(object));
  }
  return trace;
}

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
  Strategies::with(name_of(variant.strategy),
                   [&]<class S>(std::type_identity<S>) { made_from<S>(variant.strategy); });
}

ReplayResult replay(std::span<const TriangleMesh> meshes, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options) {
  check(variant);
  ReplayResult result;
  Volumes::with(variant.volume, [&]<class V>(std::type_identity<V>) {
    result = replay_with<V>(meshes, trace, variant, options);
  });
  return result;
}

}  // namespace bvlab
