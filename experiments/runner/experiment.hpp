// SPDX-License-Identifier: BSD-3-Clause
/// Runs a definition into a record. Cells that share a trace are run together: counted runs side by
/// side on all cores, then timed ones alone, uncounted, their order drawn anew for each repetition.
/// Every answer is compared with that of recursive spheres at exact precision; how many differ is
/// written beside the times.
#pragma once

#include <filesystem>
#include <functional>

#include "experiments/runner/definition.hpp"

namespace bvlab {

/// Called with the traces finished and all of them.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

/// Writes `<record>/<name>.csv`, one row for each cell and repetition, and, where the definition
/// asks for a series, `<name>.frames.csv`. Traces whose rows are all there already are passed over.
/// Throws Unusable for unknown names in the definition, before anything is run.
void run_experiment(const Definition& definition, const std::filesystem::path& record,
                    const Progress& progress);

}  // namespace bvlab
