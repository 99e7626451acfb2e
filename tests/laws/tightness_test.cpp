// SPDX-License-Identifier: BSD-3-Clause
/// The study of tightness: it has a row for every level, and no volume says more than the distance.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "experiments/replay/registry.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

using Fields = std::map<std::string, std::string>;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

/// Runs what the text defines, in a folder of its own that is removed again.
std::vector<Fields> rows_of(const std::string& text) {
  const auto definition = study_from(text, "tightness.toml");
  check(*definition);
  std::string folder = (std::filesystem::temp_directory_path() / "tightness.XXXXXX").string();
  if (!mkdtemp(folder.data())) return {};
  run_study(*definition, folder, [](std::size_t, std::size_t) {});
  std::vector<Fields> rows;
  {
    std::ifstream in(folder + "/" + definition->name + ".csv");
    std::string line;
    std::getline(in, line);
    const auto names = split(line);
    while (std::getline(in, line)) {
      const auto values = split(line);
      auto& row = rows.emplace_back();
      for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = values.at(i);
    }
  }
  std::filesystem::remove_all(folder);
  return rows;
}

TEST(Tightness, IsOfEveryLevelAndNeverNegative) {
  const auto rows = rows_of(
      "name = 'tightness'\nkind = 'tightness'\n[parameters]\n"
      "mesh = ['torus:300', 'knot:300']\nbuilds = ['top-down-principal', 'bottom-up']\n"
      "nodes = 8\nprobes = 64\n");
  std::map<std::string, int> levels;
  for (auto row : rows) {
    const std::string what = row["mesh"] + " " + row["volume"] + " " + row["build"] + " " +
                             row["fit"] + " level " + row["level"];
    SCOPED_TRACE(what);
    EXPECT_EQ(std::stoi(row["level"]),
              levels[row["mesh"] + row["volume"] + row["build"] + row["fit"]]++);
    EXPECT_GE(std::stod(row["least"]), 0);
    EXPECT_LE(std::stod(row["least"]), std::stod(row["lower_quartile"]));
    EXPECT_LE(std::stod(row["lower_quartile"]), std::stod(row["median"]));
    EXPECT_LE(std::stod(row["median"]), std::stod(row["upper_quartile"]));
    EXPECT_LE(std::stod(row["upper_quartile"]), std::stod(row["largest"]));
    // A probe is one diameter away at most.
    EXPECT_LE(std::stod(row["largest"]), 1 + 1e-9);
    EXPECT_GT(std::stod(row["mean"]), 0);
    EXPECT_GE(std::stoi(row["probes"]), 64);
  }
  // Every volume that was compiled, and its tight fit where there is one, on two meshes by two
  // builds.
  std::size_t fits = 0;
  for (const VolumeEntry* volume : volume_entries()) fits += volume->has_tight_fit ? 2 : 1;
  EXPECT_EQ(levels.size(), 4 * fits);
  for (const auto& [what, count] : levels) EXPECT_GE(count, 8) << what;
}

}  // namespace
}  // namespace bvlab
