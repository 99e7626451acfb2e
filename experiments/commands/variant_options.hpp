// SPDX-License-Identifier: BSD-3-Clause
/// Options that several commands have for what is run: the meshes, and the variant.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "experiments/commands/number.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/variant_parameters.hpp"
#include "experiments/scenes/read_mesh.hpp"

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

inline constexpr const char* what_poses_are = "poses: .npy, float64, (frames, objects, 7)";

/// The files that such a command reads, with their options.
inline std::vector<NamedFile> files_read(const std::string& trace,
                                         const std::vector<std::string>& meshes) {
  std::vector<NamedFile> files{{"--trace", trace}};
  for (const auto& mesh : meshes) files.push_back({"--mesh", mesh});
  return files;
}

/// The meshes of these files. Says where their size is such that nothing is culled.
inline std::vector<TriangleMesh> read_meshes(const std::vector<std::string>& files, double scale) {
  std::vector<TriangleMesh> meshes;
  for (const auto& file : files) {
    meshes.push_back(read_mesh(file, {.scale = scale}));
    say_if_nothing_is_culled(meshes.back(), file);
  }
  return meshes;
}

/// The option of a parameter: "--leaf-size" of "leaf_size".
inline std::string option_of(std::string_view parameter) {
  std::string option = "--" + std::string(parameter);
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

/// The options of a variant's parameters whose names are given.
inline void add_variant_options(CLI::App& command, Variant& variant,
                                std::initializer_list<std::string_view> names) {
  visit_parameters(variant, [&](std::string_view name, auto& value, std::string_view what, SetBy) {
    if (std::find(names.begin(), names.end(), name) == names.end()) return;
    CLI::Option* const option =
        command.add_option(option_of(name), value, std::string(what))->capture_default_str();
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<T, double>) option->check(number());
    if constexpr (std::is_same_v<T, std::uint32_t>) option->check(whole_number(1, 1u << 16));
  });
}

}  // namespace bvlab
