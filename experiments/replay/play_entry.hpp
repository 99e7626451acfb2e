// SPDX-License-Identifier: BSD-3-Clause
/// A strategy under a query, as the program sees it while it runs: names, and functions that were
/// compiled for it by themselves.
#pragma once

#include <memory>
#include <string_view>

#include "experiments/replay/made_pairs.hpp"

namespace bvlab {

struct PlayEntry {
  std::string_view strategy, strategy_description, query, query_description;
  /// Throws Unusable where the strategy's parameter in "name:parameter" is none.
  void (*check)(std::string_view strategy);
  /// Over the gathered kernel.
  std::unique_ptr<PairsUnderSome> (*pairs)(PairsFrom& from, const Variant& variant);
};

}  // namespace bvlab
