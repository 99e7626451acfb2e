// SPDX-License-Identifier: BSD-3-Clause
/// bvlab: the command line. Exit 0 done, 2 unusable arguments or input (one line says which), 1
/// anything else.
#include <cstdio>

#include "experiments/files/unusable.hpp"
#include "experiments/runner/commands.hpp"

int main(int argc, char** argv) {
  using namespace bvlab;
  CLI::App app("bvlab: collision detection with bounding-volume hierarchies and boxes, measured");
  app.require_subcommand(1);
  add_replay(app);
  add_boxes(app);
  add_triangles(app);
  add_run(app);
  add_scene(app);
  add_list(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "bvlab: %s\n", error.what());
    return 2;
  } catch (const Unusable& error) {
    std::fprintf(stderr, "bvlab: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bvlab: %s\n", error.what());
    return 1;
  }
}
