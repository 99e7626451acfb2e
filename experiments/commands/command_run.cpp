// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab run DEFINITION.toml [--record DIR]`: runs an experiment, or goes on with a broken one;
/// with --part K/N the K-th of N parts of it, see experiments/sweep.
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/number.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/run_text.hpp"
#include "experiments/studies/side_by_side.hpp"

namespace bvlab {
namespace {

/// How far a run is, on standard error: on a terminal as a bar, once the work has taken two
/// seconds; elsewhere as a line now and then, from a thread of its own, since a single run may take
/// long.
class Reporter {
 public:
  explicit Reporter(double every) : every_(every) {
    if (!isatty(STDERR_FILENO))
      speaker_ = std::jthread([this](const std::stop_token& stop) { speak(stop); });
  }

  void operator()(std::size_t done, std::size_t all) {
    done_ = done, all_ = all;
    if (done == 0) first_ = seconds();
    if (isatty(STDERR_FILENO) && seconds() >= 2) draw();
  }

 private:
  using Clock = std::chrono::steady_clock;

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// "12 of 216 runs, 95 s left", and how many were made again.
  std::string text() const {
    const std::size_t done = done_, all = all_, again = repeated_runs();
    std::string text = std::to_string(done) + " of " + std::to_string(all);
    if (done > 0)
      text +=
          ", " +
          span((seconds() - first_) / static_cast<double>(done) * static_cast<double>(all - done)) +
          " left";
    if (again > 0)
      text += "; " + std::to_string(again) +
              " runs repeated because other work took more than a tenth of their time";
    return text;
  }

  static std::string span(double seconds) {
    char text[32];
    if (seconds < 120)
      std::snprintf(text, sizeof text, "%.0f s", seconds);
    else
      std::snprintf(text, sizeof text, "%.0f min", seconds / 60);
    return text;
  }

  void draw() const {
    constexpr std::size_t width = 40;
    const std::size_t filled = all_ ? done_ * width / all_ : width;
    std::fprintf(stderr, "\r[%s%s] %s \x1b[K", std::string(filled, '=').c_str(),
                 std::string(width - filled, ' ').c_str(), text().c_str());
    if (done_ == all_) std::fputc('\n', stderr);
  }

  void speak(const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    const auto every = std::chrono::duration<double>(every_);
    for (bool has_spoken = false;;) {
      wake_.wait_for(lock, stop, every, [] { return false; });
      if (stop.stop_requested() && !has_spoken) return;
      // Not before it is known how many there are: figures are checked first.
      if (all_ > 0) std::fprintf(stderr, "bvlab: %s\n", text().c_str()), has_spoken = true;
      if (stop.stop_requested()) return;
    }
  }

  const double every_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::size_t> done_ = 0, all_ = 0;
  std::atomic<double> first_ = 0;
  std::condition_variable_any wake_;
  std::jthread speaker_;
};

struct Arguments {
  std::string definition, record, part;
  std::size_t threads = cores_allowed();
  bool only_counts = false, lists_parts = false;
  double progress_seconds = 30;
};

void run(const Arguments& arguments) {
  RunRequest request{
      read_whole(arguments.definition), arguments.definition, arguments.record, arguments.part, {}};
  request.options.threads = arguments.threads;
  if (arguments.only_counts) request.options.measured = Measured::counts;
  if (arguments.lists_parts) {
    const NamedSize size = size_of(request);
    Totals totals;
    totals.set("name", size.name).set("parts", size.traces).set("cells", size.cells);
    return write_totals(totals, "");
  }
  Reporter reporter(arguments.progress_seconds);
  std::puts(run_text(std::move(request), std::ref(reporter)).c_str());
}

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command = app.add_subcommand("run", "Runs an experiment into a record, or resumes one");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("definition", arguments->definition, "TOML file, see experiments/definitions")
      ->required();
  command->add_option("--record", arguments->record,
                      "folder of the record (default: a new one, experiments/record/<date>.<n>)");
  command->add_option("--part", arguments->part,
                      "K/N: run the K-th of N parts, into a record of its own");
  command->add_flag("--parts", arguments->lists_parts,
                    "run nothing; print the largest number of parts, and the number of cells");
  command->add_flag("--counts", arguments->only_counts,
                    "measure counts and answers only, on all threads");
  command
      ->add_option("--threads", arguments->threads,
                   "threads for what is not timed (default: all cores)")
      ->check(whole_number(1, 1024));
  command
      ->add_option("--progress", arguments->progress_seconds,
                   "seconds between lines of progress, where standard error is no terminal")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  command->callback([arguments] { run(*arguments); });
}

}  // namespace bvlab
