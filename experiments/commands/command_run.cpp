// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab run DEFINITION.toml [--record DIR]`: runs an experiment, or goes on with a broken one.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "experiments/commands/commands.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/records/record.hpp"
#include "experiments/studies/experiment.hpp"
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

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("run", "Runs an experiment into a record, or goes on with one");
  auto definition = std::make_shared<std::string>();
  auto record = std::make_shared<std::string>();
  command->add_option("definition", *definition, "TOML file, see experiments/definitions")
      ->required();
  command->add_option("--record", *record,
                      "folder of the record (default: a new one, experiments/record/<date>.<n>)");
  command->callback([definition, record] {
    const std::string text = read_whole(*definition);
    const auto open = [&] {
      const std::filesystem::path folder =
          record->empty() ? fresh_record("experiments/record") : std::filesystem::path(*record);
      open_record(folder, text, "bvlab run " + *definition + " --record " + folder.string());
      return folder;
    };
    std::filesystem::path folder;
    if (const auto study = study_from(text, *definition)) {
      check(*study);
      run_study(*study, folder = open(), ProgressBar{});
    } else {
      const Definition read = parse_definition(text, *definition);
      check(read);
      run_experiment(read, folder = open(), ProgressBar{});
    }
    std::puts(folder.c_str());
  });
}

}  // namespace bvlab
