// SPDX-License-Identifier: BSD-3-Clause
/// Coherent equals fresh, for ever: every strategy over every volume, for every query, on one long
/// way, beside recursion over spheres.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "experiments/replay/replay.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/volumes.hpp"
#include "tests/stress/soak/way.hpp"
#include "tests/types_of.hpp"
#include "traversal/strategies.hpp"

namespace bvlab {
namespace {

Trace long_way(std::size_t frames) {
  Trace trace{frames, 2, {}};
  Way way;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    way.step();
    const auto values = way.values();
    trace.values.insert(trace.values.end(), values.begin(), values.end());
  }
  return trace;
}

class SoakOfVolumes : public ::testing::Test {
 protected:
  static ReplayResult played(const Variant& variant, bool series = false) {
    ReplayOptions options;
    options.keep_series = series;
    return replay(meshes(), trace(), variant, options);
  }
  static const Trace& trace() {
    static const Trace made = long_way(soak_frames(3000));
    return made;
  }
  static const std::vector<TriangleMesh>& meshes() {
    static const std::vector<TriangleMesh> made{formula_mesh("star", 60),
                                                formula_mesh("torus", 64)};
    return made;
  }
  static const ReplayResult& fresh(const std::string& query) {
    static std::map<std::string, ReplayResult> all;
    const auto at = all.find(query);
    if (at != all.end()) return at->second;
    Variant variant;
    variant.query = query;
    return all.emplace(query, played(variant)).first->second;
  }
};

template <class V>
struct OfVolume : SoakOfVolumes {};
TYPED_TEST_SUITE(OfVolume, TypesOf<Volumes>);

TYPED_TEST(OfVolume, CoherentEqualsFresh) {
  Strategies::for_each([&]<class S>(std::type_identity<S>) {
    Variant variant;
    variant.volume = TypeParam::name, variant.strategy = S::name;
    variant.query = "touching";
    EXPECT_EQ(this->played(variant).touching, this->fresh("touching").touching) << S::name;
    variant.query = "contacts";
    const ReplayResult contacts = this->played(variant, true);
    EXPECT_EQ(contacts.contacts, this->fresh("contacts").contacts) << S::name;
    // A front holds no more than the pairs of leaves.
    for (const auto& frame : contacts.series) ASSERT_LE(frame.front, 60 * 64) << S::name;
    variant.query = "distance";
    const auto distances = this->played(variant).distances;
    const auto& truth = this->fresh("distance").distances;
    ASSERT_EQ(distances.size(), truth.size());
    for (std::size_t frame = 0; frame < truth.size(); ++frame)
      ASSERT_NEAR(distances[frame], truth[frame], 1e-12 * truth[frame])
          << S::name << ", frame " << frame;
  });
}

}  // namespace
}  // namespace bvlab
