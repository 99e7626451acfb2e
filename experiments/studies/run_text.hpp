// SPDX-License-Identifier: BSD-3-Clause
/// Runs what a definition says, an experiment or a study, into a record.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "experiments/studies/experiment.hpp"

namespace bvlab {

struct RunRequest {
  std::string text;    ///< the definition
  std::string file;    ///< its path, for messages and for the record's command
  std::string record;  ///< folder; a new one, experiments/record/<date>.<n>, where empty
  std::string part;    ///< "3/8"; the whole where empty
  RunOptions options;  ///< its part is set by `part`
  /// Called every so often while another run has the record open; may throw.
  std::function<void()> waiting = {};
};

/// Begins the record, or goes on with it; gives its folder. Throws Unusable, before anything is
/// written, for what the definition or the part cannot be.
std::filesystem::path run_text(RunRequest request, const Progress& progress);

/// What an experiment asks for, and its name.
struct NamedSize : DefinitionSize {
  std::string name;
};
/// Throws Unusable for a study, which has no parts.
NamedSize size_of(const RunRequest& request);

}  // namespace bvlab
