// SPDX-License-Identifier: BSD-3-Clause
/// bvlab: the command line. Exit 0 done, 2 unusable arguments or input (one line says which), 1
/// anything else.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/commands/commands.hpp"
#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/recorder/record.hpp"
#include "experiments/scenes/public/public_scenes.hpp"

namespace bvlab {
namespace {

/// Says what went wrong.
int complain(int exit, const std::string& what) {
  std::fprintf(stderr, "bvlab: %s\n", one_line(what).c_str());
  return exit;
}

/// What the parser has to say, and the names of the commands where none of them was named.
std::string shown(const CLI::App& app, const CLI::ParseError& error, const std::string& word) {
  if (!app.get_subcommands().empty()) return error.what();
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  return (word.empty() ? "a command is needed" : "no command '" + word + "'") +
         "; available: " + joined(commands, [](const CLI::App* each) { return each->get_name(); });
}

/// Standard output may be a full disk.
void flush_output() {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout)
    throw std::runtime_error("standard output: cannot be written" +
                             (errno ? ": " + std::string(std::strerror(errno)) : ""));
}

/// The words as the parser takes them, the last one first: `scene public:NAME` as `scene public
/// public:NAME`, since names of commands have no colons.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    if (i == 2 && words[0] == "scene" && is_public_scene(argv[i])) words.push_back("public");
    words.push_back(argv[i]);
  }
  std::reverse(words.begin(), words.end());
  return words;
}

/// What may be left out, so that an empty value would count as none.
constexpr std::string_view optional_texts[] = {"--out",  "--json",   "--csv",  "--page", "--record",
                                               "--part", "--meshes", "--from", "kind"};

void refuse_empty_values(CLI::App& app) {
  const auto not_empty = [](const std::string& value) {
    return value.empty() ? std::string("a value is needed") : std::string();
  };
  for (const std::string_view name : optional_texts)
    if (CLI::Option* option = app.get_option_no_throw(std::string(name)))
      option->check(not_empty, "");
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    refuse_empty_values(*command);
}

int parsed(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(words_of(argc, argv));
    return 0;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    return complain(2, shown(app, error, argc > 1 ? argv[1] : ""));
  } catch (const Unusable& error) {
    return complain(2, error.what());
  }
}

}  // namespace
}  // namespace bvlab

// Where even the message finds no memory, the program ends.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  using namespace bvlab;
  CLI::App app("bvlab: measures collision detection with bounding-volume hierarchies and boxes");
  app.require_subcommand(1);
  app.set_version_flag("--version", program_version(), "version, commit and compiler");
  try {
    add_replay(app);
    add_predict(app);
    add_boxes(app);
    add_triangles(app);
    add_run(app);
    add_scene(app);
    add_list(app);
    refuse_empty_values(app);
    const int exit = parsed(app, argc, argv);
    flush_output();
    return exit;
  } catch (const std::bad_alloc&) {
    return complain(1, "not enough memory");
  } catch (const std::exception& error) {
    return complain(1, error.what());
  }
}
