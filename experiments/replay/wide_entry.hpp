// SPDX-License-Identifier: BSD-3-Clause
/// A volume in wide trees under one query, as the program sees it while it runs, under every
/// strategy.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "experiments/replay/made_pairs.hpp"

namespace bvlab {

/// Whether it is one of the strategies that these kernels know: those of strategies.hpp. Others run on
/// the gathered kernel.
constexpr bool wide_strategy(std::string_view name) {
  for (const std::string_view known :
       {"recursive", "recursive-both", "witness", "separation-list", "deferred", "by-cost", "raise",
        "margins", "adaptive"})
    if (name == known) return true;
  return false;
}

struct WideEntry {
  std::string_view volume, volume_description, query;
  /// With which a kernel is fastest; 0 where it is not compiled for the volume.
  std::uint32_t (*fan_out)(std::string_view kernel);
  /// Null for a query that wide trees cannot answer.
  std::unique_ptr<PairsUnderSome> (*pairs)(PairsFrom& from, const Variant& variant);
};

}  // namespace bvlab
