// SPDX-License-Identifier: BSD-3-Clause
/// Runs a definition into a record. Cells that share a trace are run together: counted runs side by
/// side on all cores, then timed ones alone, uncounted, their order drawn anew for each repetition.
/// Each run is on the disk when it is over: who is killed loses the one under way, and a record
/// goes on with a definition of more values, repetitions, measures or figures. Every answer is
/// compared with that of recursive spheres at exact precision; how many differ is written beside
/// the times. Every row names the node that ran it, and whether its times were measured with the
/// node to itself.
#pragma once

#include <filesystem>
#include <functional>

#include "experiments/definitions/definition.hpp"

namespace bvlab {

/// Called with the runs that are over and all that are wanted: of each cell one that counts, and
/// the timed ones; of a study, with its parts.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

/// Throws Unusable, naming the definition's file, for names that do not exist and values that
/// cannot be in any of its cells. Takes no time: called before a record is opened.
void check(const Definition& definition);

/// Writes into a folder what is known of the tables before anything is run: their columns, and a
/// row for each cell, in which nothing is measured. Peers that are absent have theirs.
void write_cells(const Definition& definition, const std::filesystem::path& folder);

enum class Measured { counts_and_times, counts };

/// One of the parts that a definition is split into: traces that follow each other, as many as in
/// any other part, or one more. The rows of all parts in their order are those of a whole run.
struct Part {
  std::size_t number = 1, of = 1;
};

struct RunOptions {
  Measured measured = Measured::counts_and_times;
  Part part{};
  std::size_t threads = 1;  ///< of what is counted; times are measured in one
};

/// What a definition asks for.
struct DefinitionSize {
  std::size_t traces = 0, cells = 0;
};
DefinitionSize size_of(const Definition& definition);

/// Throws Unusable where a record of `held` cannot go on as one of the definition: each of its
/// cells is one of the definition's, with as many repetitions or fewer, and what was measured
/// beside is measured still.
void check_extends(const Definition& held, const Definition& definition);

/// Writes `<record>/<name>.csv`, one row for each cell and repetition, and, where the definition
/// asks for a series, `<name>.frames.csv`, where it measures coherence, `<name>.coherence.csv`.
/// What is there already is passed over. In the end rows have the order of the definition's
/// traces and repetitions. Before that they have the order in which they came, `unfinished.json`
/// says how many there will be, and `<name>.counted.csv` holds counts of what is not timed yet.
/// Where only counts are measured there is one row for each cell, its times are empty, and traces
/// are run side by side. Throws Unusable for a record that holds times if only counts are wanted,
/// and the other way round. Peers that were absent when the program was built are left out, and
/// named on standard error.
void run_experiment(const Definition& definition, const std::filesystem::path& record,
                    const RunOptions& options, const Progress& progress);

}  // namespace bvlab
