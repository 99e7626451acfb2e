// SPDX-License-Identifier: BSD-3-Clause
/// One volume at every width and over both scalars: the same contacts in every frame.
#pragma once

#include <gtest/gtest.h>

#include "hierarchies/builds.hpp"
#include "hierarchies/bounding_volume.hpp"
#include "tests/oracles/settings.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {

/// All contacts of all frames, tested W at a time.
template <class B, class V>
std::vector<std::array<std::uint32_t, 5>> at_width(const Played& scene) {
  std::vector<Hierarchy<V>> hierarchies;
  for (const auto& mesh : scene.meshes)
    hierarchies.emplace_back(mesh, builds::BottomUpLocal::topology(mesh, 1));
  std::vector<Shape<V>> shapes;
  for (std::size_t i = 0; i < scene.trace.objects; ++i)
    shapes.push_back(
        {&scene.meshes[i % scene.meshes.size()], &hierarchies[i % scene.meshes.size()]});
  AllPairs<B, V, Deferred> engine(
      shapes, all_object_pairs(static_cast<std::uint32_t>(shapes.size())), Deferred{});
  std::vector<std::array<std::uint32_t, 5>> contacts;
  std::vector<Pose> poses(scene.trace.objects);
  std::vector<Contact> found;
  NotCounting counter;
  for (std::size_t frame = 0; frame < scene.trace.frames; ++frame) {
    scene.trace.poses(frame, poses);
    engine.frame(
        poses, counter,
        [&](std::size_t) {
          found.clear();
          return Contacts(found);
        },
        [&](std::size_t p, const Contacts&) {
          for (const auto& [a, b] : found)
            contacts.push_back({static_cast<std::uint32_t>(frame), engine.pairs()[p].i,
                                engine.pairs()[p].j, a, b});
        });
  }
  std::sort(contacts.begin(), contacts.end());
  return contacts;
}

template <class V>
void expect_the_same_at_every_width() {
  for (const auto& setting : settings(150)) {
    const Played scene = played(setting);
    Variant variant;
    variant.query = "contacts";
    const auto contacts = replay(scene.meshes, scene.trace, variant, {}).contacts;
    using Double = Over<V, double>;
    EXPECT_EQ((at_width<float, V>(scene)), contacts) << setting.name;
    EXPECT_EQ((at_width<Batch<float, 4>, V>(scene)), contacts) << setting.name;
    EXPECT_EQ((at_width<Batch<float, 8>, V>(scene)), contacts) << setting.name;
    EXPECT_EQ((at_width<Batch<float, 16>, V>(scene)), contacts) << setting.name;
    EXPECT_EQ((at_width<double, Double>(scene)), contacts) << setting.name;
    EXPECT_EQ((at_width<Batch<double, 4>, Double>(scene)), contacts) << setting.name;
  }
}

}  // namespace bvlab
