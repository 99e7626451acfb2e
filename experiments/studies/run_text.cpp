// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/run_text.hpp"

#include <algorithm>
#include <optional>

#include "experiments/files/numbers.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/recorder/record.hpp"
#include "experiments/studies/figures_checked.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

/// "3/8"; the whole where nothing was said.
Part part_from(const std::string& text, std::size_t traces) {
  if (text.empty()) return {};
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = number_in<std::size_t>(text.substr(0, slash));
  const auto of = number_in<std::size_t>(text.substr(std::min(slash + 1, text.size())));
  if (number && of && *number >= 1 && *number <= *of && *of <= traces) return {*number, *of};
  throw Unusable("--part " + text + ": K/N is needed, K from 1 to N, and N at most " +
                 std::to_string(traces) + ", as many as there are traces");
}

/// Calls run(folder) with the folder of the record, which holds what is known before anything is
/// run. If it refuses, a new record is removed again.
template <class Run>
std::filesystem::path in_record(const RunRequest& request, const Extends& extends, Run&& run) {
  std::filesystem::path folder = request.record.empty() ? fresh_record("experiments/record")
                                                        : std::filesystem::path(request.record);
  std::string command = "bvlab run " + request.file + " --record " + folder.string();
  if (!request.part.empty()) command += " --part " + request.part;
  if (request.options.measured == Measured::counts) command += " --counts";
  const RecordLock lock = open_record(folder, request.text, command, extends, request.waiting);
  try {
    run(folder);
  } catch (const Unusable&) {
    std::error_code error;
    if (lock.made() && is_without_rows(folder)) std::filesystem::remove_all(folder, error);
    throw;
  }
  return folder;
}

[[noreturn]] void refuse_parts(const RunRequest& request) {
  throw Unusable(request.file, "a study has no parts: it is run as a whole");
}

/// Nothing where it is an experiment.
std::optional<StudyDefinition> checked_study(const RunRequest& request) {
  auto study = study_from(request.text, request.file);
  if (!study) return study;
  check(*study);
  if (study->has_figures) check_figures(request.text, request.file);
  if (!request.part.empty()) refuse_parts(request);
  if (request.options.measured == Measured::counts)
    throw Unusable(request.file,
                   "a study measures what its kind says: --counts is for experiments");
  return study;
}

Definition checked_definition(const RunRequest& request) {
  Definition definition = parse_definition(request.text, request.file);
  check(definition);
  if (definition.has_figures)
    check_figures(request.text, request.file,
                  [&](const std::filesystem::path& folder) { write_cells(definition, folder); });
  return definition;
}

}  // namespace

std::filesystem::path run_text(RunRequest request, const Progress& progress) {
  if (const auto study = checked_study(request)) {
    const auto extends = [&](const std::string& held, const std::string&) {
      const auto before = study_from(held, "its definition");
      if (!before) throw Unusable("it is not that of a study");
      check_extends(*before, *study);
    };
    return in_record(request, extends, [&](const std::filesystem::path& folder) {
      run_study(*study, folder, progress);
    });
  }
  const Definition definition = checked_definition(request);
  if (!request.part.empty())
    request.options.part = part_from(request.part, size_of(definition).traces);
  const auto extends = [&](const std::string& held, const std::string&) {
    check_extends(parse_definition(held, "its definition"), definition);
  };
  return in_record(request, extends, [&](const std::filesystem::path& folder) {
    run_experiment(definition, folder, request.options, progress);
  });
}

NamedSize size_of(const RunRequest& request) {
  if (checked_study(request)) refuse_parts(request);
  const Definition definition = checked_definition(request);
  NamedSize size{size_of(definition), definition.name};
  part_from(request.part, size.traces);
  return size;
}

}  // namespace bvlab
