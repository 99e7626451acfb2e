// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab run DEFINITION.toml [--record DIR]`: runs an experiment, or goes on with a broken one;
/// with --part K/N the K-th of N parts of it, see experiments/sweep.
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/whole_number.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/records/record.hpp"
#include "experiments/studies/experiment.hpp"
#include "experiments/studies/side_by_side.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

/// On a terminal, once the work has taken two seconds.
class ProgressBar {
 public:
  void operator()(std::size_t done, std::size_t all) {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (!isatty(STDERR_FILENO) || seconds < 2) return;
    constexpr std::size_t width = 40;
    const std::size_t filled = all ? done * width / all : width;
    const double left =
        done ? seconds / static_cast<double>(done) * static_cast<double>(all - done) : 0;
    std::fprintf(stderr, "\r[%s%s] %zu of %zu, %.0f s left \x1b[K",
                 std::string(filled, '=').c_str(), std::string(width - filled, ' ').c_str(), done,
                 all, left);
    if (done == all) std::fputc('\n', stderr);
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct Arguments {
  std::string definition, record, part;
  std::size_t threads = cores_allowed();
  bool only_counts = false, lists_parts = false;
};

/// "3/8"; the whole where nothing was said.
Part part_from(const std::string& text, std::size_t traces) {
  if (text.empty()) return {};
  Part part;
  const char* const last = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), last, part.number);
  if (error == std::errc{} && slash != last && *slash == '/')
    if (const auto [end, fault] = std::from_chars(slash + 1, last, part.of);
        fault == std::errc{} && end == last && part.number >= 1 && part.number <= part.of &&
        part.of <= traces)
      return part;
  throw Unusable("--part " + text + ": K/N is needed, K from 1 to N, and N at most " +
                 std::to_string(traces) + ", as many as there are traces");
}

/// The folder of the record, with what is known of it before anything is run.
std::filesystem::path opened(const Arguments& arguments, const std::string& text) {
  const std::filesystem::path folder = arguments.record.empty()
                                           ? fresh_record("experiments/record")
                                           : std::filesystem::path(arguments.record);
  std::string command = "bvlab run " + arguments.definition + " --record " + folder.string();
  if (!arguments.part.empty()) command += " --part " + arguments.part;
  if (arguments.only_counts) command += " --counts";
  open_record(folder, text, command);
  return folder;
}

void run_definition(const Arguments& arguments, const std::string& text) {
  const Definition definition = parse_definition(text, arguments.definition);
  check(definition);
  RunOptions options;
  options.threads = arguments.threads;
  if (arguments.only_counts) options.measured = Measured::counts;
  if (arguments.lists_parts || !arguments.part.empty()) {
    const DefinitionSize size = size_of(definition);
    options.part = part_from(arguments.part, size.traces);
    if (arguments.lists_parts) {
      Totals totals;
      totals.set("name", definition.name).set("parts", size.traces).set("cells", size.cells);
      return write_totals(totals, "");
    }
  }
  const auto folder = opened(arguments, text);
  run_experiment(definition, folder, options, ProgressBar{});
  std::puts(folder.c_str());
}

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("run", "Runs an experiment into a record, or goes on with one");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("definition", arguments->definition, "TOML file, see experiments/definitions")
      ->required();
  command->add_option("--record", arguments->record,
                      "folder of the record (default: a new one, experiments/record/<date>.<n>)");
  command->add_option("--part", arguments->part,
                      "K/N: the K-th of N parts, into a record of its own");
  command->add_flag("--parts", arguments->lists_parts,
                    "run nothing; print the number of parts that there can be, and of cells");
  command->add_flag("--counts", arguments->only_counts,
                    "time nothing: counts and answers, by all threads");
  command->add_option("--threads", arguments->threads, "of what is not timed (default: all cores)")
      ->check(whole_number(1, 1024));
  command->callback([arguments] {
    const std::string text = read_whole(arguments->definition);
    const auto study = study_from(text, arguments->definition);
    if (!study) return run_definition(*arguments, text);
    check(*study);
    if (arguments->lists_parts || arguments->only_counts || !arguments->part.empty())
      throw Unusable(arguments->definition, "a study has no parts: it is run as a whole");
    const auto folder = opened(*arguments, text);
    run_study(*study, folder, ProgressBar{});
    std::puts(folder.c_str());
  });
}

}  // namespace bvlab
