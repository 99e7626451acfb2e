// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/trace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/checked_trace.hpp"
#include "traversal/pair_choice.hpp"

namespace bvlab {

std::vector<ObjectPair> object_pairs(const Trace& trace) {
  if (trace.chosen) return *trace.chosen;
  return chosen_pairs({}, static_cast<std::uint32_t>(trace.objects));
}

Trace part_of(const Trace& trace, std::span<const std::size_t> frames) {
  const std::size_t length = 7 * trace.objects;
  Trace part{frames.size(), trace.objects, {}, trace.chosen};
  part.values.reserve(frames.size() * length);
  for (const std::size_t frame : frames) {
    const double* const first = trace.values.data() + frame * length;
    part.values.insert(part.values.end(), first, first + length);
  }
  return part;
}

Trace parse_trace(std::string_view bytes, const std::string& name) {
  constexpr std::size_t shape[] = {any_length, any_length, 7};
  auto array = parse_npy<double>(bytes, name, shape);
  return checked_trace(array.shape[0], array.shape[1], std::move(array.data), name);
}

Trace checked_trace(std::size_t frames, std::size_t objects, std::vector<double> values,
                    const std::string& name) {
  Trace trace{frames, objects, std::move(values)};
  // An array without entries can promise any lengths.
  if (std::max(trace.frames, trace.objects) > std::numeric_limits<std::uint32_t>::max())
    throw Unusable(name, "more frames or objects than 32 bits number");
  for (std::size_t i = 0; i < trace.values.size(); i += 7) {
    const double* v = trace.values.data() + i;
    if (pose_from({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6])) continue;
    const bool finite = std::all_of(v, v + 7, [](double x) { return std::isfinite(x); });
    const std::size_t object = i / 7 % trace.objects, frame = i / 7 / trace.objects;
    throw Unusable(name, std::string(finite ? "zero quaternion" : "not a finite number") +
                             " in frame " + std::to_string(frame) + ", object " +
                             std::to_string(object));
  }
  return trace;
}

void require_finite_corners(const Trace& trace, const std::string& name,
                            std::span<const TriangleMesh> meshes) {
  // No component of R v + t is above 3.1 |v| + |t|, summed up as it may be.
  constexpr double safe = std::numeric_limits<double>::max() / 8;
  std::vector<bool> small;
  for (const TriangleMesh& mesh : meshes)
    small.push_back(std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                                [](const auto& v) { return v.cwiseAbs().maxCoeff() < safe; }));
  // A trace without frames can promise any number of objects.
  std::vector<Pose> poses;
  for (std::size_t frame = 0; frame < trace.frames && trace.objects > 0; ++frame) {
    const double* v = trace.values.data() + frame * trace.objects * 7;
    bool posed = false;
    for (std::size_t object = 0; object < trace.objects; ++object, v += 7) {
      const auto small_number = [](double x) { return std::abs(x) < safe; };
      const std::size_t mesh = object % meshes.size();
      if (small[mesh] && std::all_of(v, v + 3, small_number)) continue;
      if (!posed) poses.resize(trace.objects), trace.poses(frame, poses), posed = true;
      for (const auto& triangle : meshes[mesh].triangles)
        for (const auto vertex : triangle)
          if (!poses[object](meshes[mesh].vertices[vertex]).allFinite())
            throw Unusable(name, "vertex " + std::to_string(vertex) +
                                     " is beyond the largest number in frame " +
                                     std::to_string(frame) + ", object " + std::to_string(object));
    }
  }
}

Trace read_trace(const std::string& path) { return parse_trace(read_whole(path), path); }

}  // namespace bvlab
