// SPDX-License-Identifier: BSD-3-Clause
/// bvlab: the command line. Exit 0 done, 2 unusable arguments or input (one line says which), 1
/// anything else.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>

#include "experiments/commands/commands.hpp"
#include "experiments/files/unusable.hpp"

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
  std::string names;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names += (names.empty() ? "" : ", ") + command->get_name();
  return (word.empty() ? "a command is needed" : "no command '" + word + "'") + "; there are " +
         names;
}

/// Standard output may be a full disk.
void flush_output() {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout)
    throw std::runtime_error("standard output: cannot be written" +
                             (errno ? ": " + std::string(std::strerror(errno)) : ""));
}

int parsed(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return complain(2, shown(app, error, argc > 1 ? argv[1] : ""));
  } catch (const Unusable& error) {
    return complain(2, error.what());
  }
}

}  // namespace
}  // namespace bvlab

int main(int argc, char** argv) {
  using namespace bvlab;
  CLI::App app("bvlab: collision detection with bounding-volume hierarchies and boxes, measured");
  app.require_subcommand(1);
  try {
    add_replay(app);
    add_predict(app);
    add_boxes(app);
    add_triangles(app);
    add_run(app);
    add_scene(app);
    add_list(app);
    const int exit = parsed(app, argc, argv);
    flush_output();
    return exit;
  } catch (const std::bad_alloc&) {
    return complain(1, "not enough memory");
  } catch (const std::exception& error) {
    return complain(1, error.what());
  }
}
