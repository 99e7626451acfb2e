// SPDX-License-Identifier: BSD-3-Clause
/// One volume at every width and over both scalars: the same contacts in every frame.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/registry.hpp"
#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/builds.hpp"
#include "tests/oracles/settings.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/bodies.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/strategies/separation_list.hpp"

namespace bvlab {

/// All contacts of all frames, tested W at a time.
template <class B, class V>
std::vector<std::array<std::uint32_t, 5>> at_width(const Played& scene,
                                                   const std::vector<Shape<V>>& shapes) {
  Bodies<B, V> bodies(shapes, Frame::world);
  const auto pairs = all_object_pairs(static_cast<std::uint32_t>(shapes.size()));
  std::vector<Deferred> strategies(pairs.size());
  std::vector<std::array<std::uint32_t, 5>> contacts;
  std::vector<Pose> poses(scene.trace.objects);
  std::vector<Contact> found;
  NotCounting counter;
  std::optional<Vec3<double>> origin;
  for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
    scene.trace.poses(frame, poses);
    if (!origin) origin = centre_of(poses, bodies);
    bodies.move(poses, *origin);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      found.clear();
      Contacts query(found);
      strategies[p].run(bodies.pair(pairs[p], query, counter));
      for (const auto& [a, b] : found)
        contacts.push_back({static_cast<std::uint32_t>(frame), pairs[p].i, pairs[p].j, a, b});
    }
  }
  std::sort(contacts.begin(), contacts.end());
  return contacts;
}

/// The width of the program's own loops is played by them.
template <int W, class V>
std::vector<std::array<std::uint32_t, 5>> at_width_of_floats(const Played& scene, Variant variant,
                                                             const std::vector<Shape<V>>& shapes) {
  if constexpr (std::is_same_v<Batch<float, W>, NativeBatch<float>>) {
    variant.strategy = Deferred::name, variant.query = Contacts::name;
    return replay(scene.meshes, scene.trace, variant, {}).contacts;
  } else {
    return at_width<Batch<float, W>>(scene, shapes);
  }
}

template <class V>
void expect_the_same_at_every_width() {
  for (const auto& setting : settings(150)) {
    const Played scene = played(setting);
    Variant variant;
    variant.query = "contacts";
    const auto contacts = replay(scene.meshes, scene.trace, variant, {}).contacts;
    Variant local;
    local.volume = V::name, local.build = builds::BottomUpLocal::name;
    const auto hierarchies = volume_entry(V::name).hierarchies(scene.meshes, local);
    const auto shapes =
        static_cast<const HierarchiesOf<V>&>(*hierarchies).shapes(scene.trace.objects);
    EXPECT_EQ((at_width<float>(scene, shapes)), contacts) << setting.name;
    EXPECT_EQ((at_width_of_floats<4>(scene, local, shapes)), contacts) << setting.name;
    EXPECT_EQ((at_width_of_floats<8>(scene, local, shapes)), contacts) << setting.name;
    EXPECT_EQ((at_width_of_floats<16>(scene, local, shapes)), contacts) << setting.name;
    const HierarchiesOf<Over<V, double>> in_double(scene.meshes, local);
    const auto wide = in_double.shapes(scene.trace.objects);
    EXPECT_EQ((at_width<double>(scene, wide)), contacts) << setting.name;
    EXPECT_EQ((at_width<Batch<double, 4>>(scene, wide)), contacts) << setting.name;
  }
}

}  // namespace bvlab
