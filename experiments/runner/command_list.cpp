// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab list [KIND]`: one line each, the name, then what it is.
#include <cstdio>

#include "experiments/runner/commands.hpp"

namespace bvlab {

void add_list(CLI::App& app) {
  CLI::App* command = app.add_subcommand("list", "Lists the names of what there is");
  command->callback([] { std::puts(""); });
}

}  // namespace bvlab
