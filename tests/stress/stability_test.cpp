// SPDX-License-Identifier: BSD-3-Clause
/// A small stability map: under every stressor, `exact` is never wrong with any volume, strategy
/// and tree, and the cheaper precisions miss no contact.
#include <gtest/gtest.h>

#include <set>

#include "experiments/replay/replay.hpp"
#include "experiments/studies/stressors.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

/// Every fan-out, both frames and every kernel are stressed.
TEST(Stability, VariantsAreOfEveryKind) {
  std::set<std::string> kinds;
  for (const auto& variant : stressed_variants()) {
    kinds.insert(std::to_string(variant.fan_out));
    kinds.insert(variant.frame);
    kinds.insert(variant.kernel);
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"2", "4", "8", "16", "world", "body", "gathered",
                                          "siblings", "mixed"}));
}

class Stressed : public testing::TestWithParam<Stressor> {};

TEST_P(Stressed, NobodyIsWrong) {
  constexpr std::size_t frames = 24;
  std::size_t touching = 0, apart = 0;
  for (const double level : GetParam().levels) {
    const StressCase stress = GetParam().make(level, frames, 7);
    const auto truth = truth_of(stress);
    for (const auto each : truth) ++(each ? touching : apart);
    for (const auto& variant : stressed_variants()) {
      const bool exact = variant.precision == Exact::name;
      const auto said = replay(stress.meshes, stress.trace, variant, {}).touching;
      ASSERT_EQ(said.size(), truth.size());
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const auto where = [&] {
          return variant.kernel + ' ' + std::to_string(variant.fan_out) + ' ' + variant.frame +
                 ' ' + variant.volume + ' ' + variant.strategy + ' ' +
                 variant.precision + " level " + std::to_string(level);
        };
        ASSERT_GE(said[i], truth[i]) << where();
        ASSERT_LE(said[i], exact ? truth[i] : 1) << where();
      }
    }
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
