// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/figures_checked.hpp"

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "experiments/files/spawned.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"

namespace bvlab {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with its object; empty where none can be made.
class Scratch {
 public:
  Scratch() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "bvlab-figures-XXXXXX").string();
    if (!error && mkdtemp(name.data())) path_ = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// plots/draw of the source tree, or of an installed program.
fs::path drawing_program() {
  std::error_code error;
  fs::path in_source = fs::path(BVLAB_PLOTS_DIRECTORY) / "draw";
  if (fs::exists(in_source, error)) return in_source;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path() / "../../../share/bvlab/plots/draw";
}

/// The last line that is not empty.
std::string_view last_line(std::string_view text) {
  const std::size_t end = text.find_last_not_of(" \n");
  if (end == text.npos) return {};
  text = text.substr(0, end + 1);
  return text.substr(text.rfind('\n') + 1);
}

void say_unchecked(const std::string& why) {
  std::fprintf(stderr, "bvlab: figures were not checked: %s\n", one_line(why).c_str());
}

}  // namespace

void check_figures(const std::string& text, const std::string& file,
                   const WritesTables& write_tables) {
  const Scratch scratch;
  if (scratch.path().empty()) return say_unchecked("no folder for temporary files");
  const fs::path definition = scratch.path() / "definition.toml";
  write_whole(definition, text);
  if (write_tables) write_tables(scratch.path());
  const std::string asked = (write_tables ? scratch.path() : definition).string();
  const Spawned run = spawned({drawing_program().string(), "--check", asked}, Stream::error);
  if (run.status == 0) return;
  std::string said(last_line(run.text));
  const std::string before = "draw: " + asked + ": ";
  if (said.starts_with(before)) said.erase(0, before.size());
  if (run.status == 2) throw Unusable(file, said);
  if (said.empty()) said = drawing_program().string() + " does not run; is python3 there?";
  say_unchecked(said);
}

}  // namespace bvlab
