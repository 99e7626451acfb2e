// SPDX-License-Identifier: BSD-3-Clause
/// The example of hierarchies/adding_a_volume.md: a volume from outside keeps every law and gives
/// every answer.
#include "tests/example/capsule.hpp"

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "tests/laws/volume_laws.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

using Capsules = TypesInBothPrecisions<TypeList<Capsule<float>>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Example, VolumeLaws, Capsules);

template <class V>
std::vector<Contact> contacts_over(const TriangleMesh& mesh) {
  const Hierarchy<V> hierarchy(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  const std::vector<Shape<V>> shapes(2, {&mesh, &hierarchy});
  AllPairs<Batch<float, 4>, V, Deferred> bodies(shapes, all_object_pairs(2), Deferred{});
  std::vector<Contact> found, all;
  NotCounting counter;
  for (int frame = 0; frame < 100; ++frame) {
    const std::vector<Pose> poses{
        *pose_from({0, 0, 0}, 1, 0, 0, 0),
        *pose_from({2.5 - 0.03 * frame, 0.1, 0}, 1, 0.01 * frame, 0.3, 0)};
    found.clear();
    bodies.frame(
        poses, counter, [&](std::size_t) { return Contacts(found); },
        [](std::size_t, const Contacts&) {});
    std::sort(found.begin(), found.end());
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

TEST(Capsule, GivesTheContactsThatSpheresGive) {
  const TriangleMesh mesh = formula_mesh("torus", 400);
  const auto contacts = contacts_over<Sphere<float>>(mesh);
  EXPECT_GT(contacts.size(), 1000u);
  EXPECT_EQ(contacts_over<Capsule<float>>(mesh), contacts);
}

}  // namespace
}  // namespace bvlab
