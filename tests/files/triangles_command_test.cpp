// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab triangles` from outside: its verdicts, its totals, and each refusal's message.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/files/npy.hpp"
#include "experiments/scenes/triangle_sets.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit;
  std::string text;  ///< standard output and standard error
};

class TrianglesCommand : public testing::Test {
 protected:
  void SetUp() override {
    std::string place = (fs::temp_directory_path() / "bvlab_triangles_XXXXXX").string();
    ASSERT_NE(::mkdtemp(place.data()), nullptr);
    folder_ = place;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  Outcome run(const std::string& arguments) const {
    const std::string command = "'" BVLAB_PROGRAM "' triangles " + arguments + " 2>&1";
    std::FILE* pipe = ::popen(command.c_str(), "r");
    Outcome outcome{};
    char block[4096];
    while (const std::size_t n = std::fread(block, 1, sizeof block, pipe))
      outcome.text.append(block, n);
    outcome.exit = WEXITSTATUS(::pclose(pipe));
    return outcome;
  }

  void write(const std::string& name, std::size_t rows, std::size_t columns,
             const std::vector<double>& data) const {
    const std::size_t shape[] = {rows, columns};
    write_npy<double>(file(name), shape, data);
  }

  void expect_refused(const std::string& arguments, const std::string& message) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_EQ(outcome.text, "bvlab: " + message + "\n");
    EXPECT_FALSE(fs::exists(file("verdicts.npy")));
  }

  fs::path folder_;
};

TEST_F(TrianglesCommand, VerdictsAndTotals) {
  std::vector<double> data;
  std::vector<std::uint8_t> expected;
  for (const TriangleSet& set : triangle_sets)
    for (const TrianglePair& pair : set.make(100, 3)) {
      for (const auto& t : pair)
        for (const auto& p : t) data.insert(data.end(), p.data(), p.data() + 3);
      expected.push_back(intersect(pair[0], pair[1]));
    }
  write("pairs.npy", expected.size(), 18, data);
  const Outcome outcome = run("--pairs " + file("pairs.npy") + " --out " + file("verdicts.npy") +
                              " --json " + file("totals.json"));
  EXPECT_EQ(outcome.exit, 0);
  EXPECT_EQ(outcome.text, "");
  const std::size_t any[] = {any_length};
  EXPECT_EQ(read_npy<std::uint8_t>(file("verdicts.npy"), any).data, expected);
  const auto totals = nlohmann::json::parse(std::ifstream(file("totals.json")));
  EXPECT_EQ(totals.at("pairs"), expected.size());
  EXPECT_EQ(totals.at("touching"), std::count(expected.begin(), expected.end(), 1));
  EXPECT_EQ(totals.at("frames"), 1);
  EXPECT_EQ(totals.at("build_seconds"), 0);
  EXPECT_GT(totals.at("seconds"), 0);
  EXPECT_EQ(totals.at("first_seconds"), totals.at("seconds"));
  EXPECT_GT(totals.at("peak_bytes"), 1 << 16);
}

TEST_F(TrianglesCommand, EveryPrecisionIsKnown) {
  write("pairs.npy", 1, 18, std::vector<double>(18, 0.5));
  for (const std::string precision : {"exact", "float64", "float32"}) {
    const Outcome outcome = run("--pairs " + file("pairs.npy") + " --precision " + precision);
    EXPECT_EQ(outcome.exit, 0);
    EXPECT_EQ(nlohmann::json::parse(outcome.text).at("touching"), 1);
  }
}

TEST_F(TrianglesCommand, NoPairsIsLegal) {
  write("pairs.npy", 0, 18, {});
  EXPECT_EQ(run("--pairs " + file("pairs.npy") + " --out " + file("verdicts.npy")).exit, 0);
  const std::size_t any[] = {any_length};
  EXPECT_TRUE(read_npy<std::uint8_t>(file("verdicts.npy"), any).data.empty());
}

TEST_F(TrianglesCommand, EachFaultIsNamed) {
  const std::string pairs = file("pairs.npy"), rest = " --out " + file("verdicts.npy");
  expect_refused("--pairs " + pairs + rest, pairs + ": No such file or directory");
  std::vector<double> data(36, 1.0);
  data[18 + 7] = std::numeric_limits<double>::quiet_NaN();
  write("pairs.npy", 2, 18, data);
  expect_refused("--pairs " + pairs + rest, pairs + ": pair 1, number 7 is NaN");
  data[18 + 7] = 0, data[17] = -std::numeric_limits<double>::infinity();
  write("pairs.npy", 2, 18, data);
  expect_refused("--pairs " + pairs + rest, pairs + ": pair 0, number 17 is infinite");
  write("pairs.npy", 4, 9, std::vector<double>(36));
  expect_refused("--pairs " + pairs + rest, pairs + ": has shape (4, 9) where (*, 18) is needed");
  const std::size_t shape[] = {1, 18};
  write_npy<float>(pairs, shape, std::vector<float>(18));
  expect_refused("--pairs " + pairs + rest, pairs + ": holds '<f4' where '<f8' is needed");
  write("pairs.npy", 1, 18, std::vector<double>(18));
  expect_refused("--pairs " + pairs + rest + " --precision float16",
                 "--precision: unknown name 'float16'; available: exact, float64, float32");
  fs::resize_file(pairs, fs::file_size(pairs) - 1);
  expect_refused("--pairs " + pairs + rest, pairs + ": truncated: holds 17 of 18 values");
}

}  // namespace
}  // namespace bvlab
