// SPDX-License-Identifier: BSD-3-Clause
/// Options that several commands have for what is run: the trees, and the query.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/commands/number.hpp"
#include "experiments/replay/registry.hpp"

namespace bvlab {

/// --scale, of files that are read.
inline void add_scale_option(CLI::App& command, double& scale) {
  command
      .add_option("--scale", scale,
                  "coordinates of mesh files are multiplied by it, for files in another unit; "
                  "otherwise they are used as they stand")
      ->check(number())
      ->capture_default_str();
}

/// --mesh and --scale.
inline void add_mesh_options(CLI::App& command, std::vector<std::string>& files, double& scale) {
  command
      .add_option("--mesh", files,
                  "mesh file; object i uses mesh i mod their number; the transformations of a "
                  "scene's nodes are applied, its unit and axes are not")
      ->required();
  add_scale_option(command, scale);
}

/// --volume, --fan-out and --frame.
inline void add_tree_options(CLI::App& command, Variant& variant) {
  command.add_option("--volume", variant.volume, "see `bvlab list volumes`")->capture_default_str();
  command.add_option("--fan-out", variant.fan_out, "most children of a node: 2, 4, 8 or 16")
      ->capture_default_str();
  command
      .add_option("--frame", variant.frame,
                  "frame in which volumes are compared: world or body; see `bvlab list frames`")
      ->capture_default_str();
}

/// --build and --fit.
inline void add_build_options(CLI::App& command, Variant& variant) {
  command.add_option("--build", variant.build, "see `bvlab list builds`")->capture_default_str();
  command.add_option("--fit", variant.fit, "how volumes are fitted: published or tight")
      ->capture_default_str();
}

/// --query and --relative-error.
inline void add_query_options(CLI::App& command, Variant& variant) {
  command.add_option("--query", variant.query, "see `bvlab list queries`")->capture_default_str();
  command
      .add_option(
          "--relative-error", variant.relative_error,
          "largest relative error of a distance; it is not below the exact one by more than "
          "rounding")
      ->check(number())
      ->capture_default_str();
}

}  // namespace bvlab
