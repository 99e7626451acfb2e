// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/tori.hpp"

#include <cmath>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/circle.hpp"

namespace bvlab {
namespace {

/// w x y z of a turn about x, then one about y.
std::array<double, 4> attitude(double turns_about_x, double turns_about_y) {
  const auto [cx, sx] = cosine_sine(turns_about_x / 2);
  const auto [cy, sy] = cosine_sine(turns_about_y / 2);
  return {cy * cx, cy * sx, sy * cx, -sy * sx};
}

}  // namespace

void Tori::check() const {
  if (!(std::abs(turns) <= 1e6)) throw Unusable("turns: must be -1e6 to 1e6");
  if (frames > std::size_t{1} << 31) throw Unusable("frames: more than 2^31");
}

Array<double> Tori::generate(std::span<const Extent> meshes, const TouchesAny&) const {
  check();
  if (meshes.empty()) throw Unusable("no mesh to move");
  const double height = resolved(fall, meshes, "fall"), away = resolved(wobble, meshes, "wobble");
  const Vec3<double>& centre = meshes[1 % meshes.size()].centre;
  Array<double> trace{{frames, objects, 7}, {}};
  trace.data.reserve(frames * objects * 7);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double fallen =
        frames > 1 ? static_cast<double>(frame) / static_cast<double>(frames - 1) : 0;
    const auto q = attitude(turns * fallen, turns / 2 * fallen);
    const auto pose = *pose_from({0, 0, 0}, q[0], q[1], q[2], q[3]);
    // Its centre draws a rose: out and back again three times, once round.
    const auto [x, y] = cosine_sine(fallen);
    const double out = away * cosine_sine(1.5 * fallen).second;
    const Vec3<double> turned = pose(centre);
    const Vec3<double> at(out * x - turned[0], out * y - turned[1],
                          height * (1 - 2 * fallen) - turned[2]);
    trace.data.insert(trace.data.end(), {0, 0, 0, 1, 0, 0, 0});
    trace.data.insert(trace.data.end(), {at[0], at[1], at[2], q[0], q[1], q[2], q[3]});
  }
  return trace;
}

}  // namespace bvlab
