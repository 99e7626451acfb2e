// SPDX-License-Identifier: BSD-3-Clause
/// Runs a definition into a record. Cells that share a trace are run together: counted runs side by
/// side on all cores, then timed ones alone, uncounted, their order drawn anew for each repetition.
/// Every answer is compared with that of recursive spheres at exact precision; how many differ is
/// written beside the times.
#pragma once

#include <filesystem>
#include <functional>

#include "experiments/definitions/definition.hpp"

namespace bvlab {

/// Called with the traces finished and all of them.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

/// Throws Unusable, naming the definition's file, for names that do not exist and values that
/// cannot be in any of its cells. Takes no time: asked before a record is opened.
void check(const Definition& definition);

/// Writes `<record>/<name>.csv`, one row for each cell and repetition, and, where the definition
/// asks for a series, `<name>.frames.csv`, where it measures coherence, `<name>.coherence.csv`.
/// Traces whose rows are all there already are passed over. Peers that were absent when the program
/// was built are left out, and named on standard error.
void run_experiment(const Definition& definition, const std::filesystem::path& record,
                    const Progress& progress);

}  // namespace bvlab
