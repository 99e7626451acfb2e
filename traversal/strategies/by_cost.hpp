// SPDX-License-Identifier: BSD-3-Clause
/// A separation list that is rebuilt when keeping it has become more expensive than a rebuild.
///
/// On binary trees, a rebuild that finds n leaves of the test tree takes 2n - 1 tests; each later
/// run takes n and, as the list grows and becomes outdated, more. As for any machine that wears
/// out, the mean cost of a run, rebuild included, is least if the list is replaced when one more
/// run costs more than the mean so far. That needs no parameter: at rest the mean falls from 2n
/// towards n and the list is never rebuilt; where growth costs more than a rebuild saves, it is
/// kept for one run.
#pragma once

#include <string_view>

#include "traversal/strategies/separation_list.hpp"

namespace bvlab {

class ByCost : public RebuiltList {
 public:
  static constexpr std::string_view name = "by-cost";
  static constexpr std::string_view description =
      "separation list, rebuilt once a run costs more than the mean since the last rebuild";

  ByCost() : RebuiltList(RebuildRule::by_mean_cost()) {}
};

}  // namespace bvlab
