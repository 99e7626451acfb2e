// SPDX-License-Identifier: BSD-3-Clause
/// The commands of the bvlab program: each adds itself to the command line. One file a command,
/// `command_<name>.cpp`.
#pragma once

#include <CLI/CLI.hpp>

namespace bvlab {

void add_replay(CLI::App& app);
void add_predict(CLI::App& app);
void add_boxes(CLI::App& app);
void add_triangles(CLI::App& app);
void add_run(CLI::App& app);
void add_scene(CLI::App& app);
void add_list(CLI::App& app);

}  // namespace bvlab
