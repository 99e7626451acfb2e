// SPDX-License-Identifier: BSD-3-Clause
/// A small stability map: under every stressor, `exact` is never wrong with any volume and
/// strategy, and the cheaper precisions miss no contact.
#include <gtest/gtest.h>

#include "experiments/replay/registry.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/studies/stressors.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

class Stressed : public testing::TestWithParam<Stressor> {};

TEST_P(Stressed, NobodyIsWrong) {
  constexpr std::size_t frames = 24;
  std::size_t touching = 0, apart = 0;
  for (const double level : GetParam().levels) {
    const StressCase stress = GetParam().make(level, frames, 7);
    const auto truth = truth_of(stress);
    for (const auto each : truth) ++(each ? touching : apart);
    for (const auto& volume : volumes())
      for (const auto& strategy : strategies())
        Precisions::for_each([&]<class P>(std::type_identity<P>) {
          Variant variant;
          variant.volume = volume.name, variant.strategy = strategy.name;
          variant.precision = P::name;
          const auto said = replay(stress.meshes, stress.trace, variant, {}).touching;
          ASSERT_EQ(said.size(), truth.size());
          for (std::size_t i = 0; i < truth.size(); ++i) {
            ASSERT_GE(said[i], truth[i])
                << volume.name << ' ' << strategy.name << ' ' << P::name << " level " << level;
            ASSERT_LE(said[i], P::has_fallback ? truth[i] : 1)
                << volume.name << ' ' << strategy.name << ' ' << P::name << " level " << level;
          }
        });
  }
  // Worth its name only where both answers occur.
  EXPECT_GT(touching, 0u);
  EXPECT_GT(apart, 0u);
}

INSTANTIATE_TEST_SUITE_P(Stability, Stressed, testing::ValuesIn(stressors()), [](const auto& info) {
  std::string name(info.param.name);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
});

}  // namespace
}  // namespace bvlab
