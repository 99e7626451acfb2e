// SPDX-License-Identifier: BSD-3-Clause
/// The totals of a replay: times, counts, the length of the front, and the variant they are of.
#pragma once

#include <cstdint>
#include <span>

#include "experiments/files/totals.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/replay/replay_budgeted.hpp"

namespace bvlab {

/// Counts are null where nothing was counted. Where something was, the recursive strategy is played
/// once more, to say what was skipped.
Totals totals_of(const ReplayResult& result, std::span<const TriangleMesh> meshes,
                 const Trace& trace, const Variant& variant, const ReplayOptions& options);

Totals totals_of(const BudgetedResult& result, const Trace& trace, const Variant& variant,
                 std::uint64_t budget, Count count);

}  // namespace bvlab
