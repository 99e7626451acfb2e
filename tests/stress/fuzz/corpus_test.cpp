// SPDX-License-Identifier: BSD-3-Clause
/// The fuzzer's seeds, and whatever once broke a reader, through the same readers; and all that is
/// left of the seeds when bytes are missing or wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/files/whole_file.hpp"
#include "tests/stress/fuzz/targets.hpp"

namespace bvlab::fuzz {
namespace {

std::vector<std::string> corpus(std::string_view name) {
  std::vector<std::string> all;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(BVLAB_CORPUS) / name))
    all.push_back(read_whole(entry.path()));
  return all;
}

TEST(Corpus, IsTakenOrRefused) {
  for (const auto& [name, target] : targets) {
    const auto all = corpus(name);
    EXPECT_FALSE(all.empty()) << name;
    for (const auto& bytes : all) target(bytes);
    target("");
  }
}

TEST(Corpus, IsTakenOrRefusedAtEveryLength) {
  for (const auto& [name, target] : targets)
    for (const auto& bytes : corpus(name)) {
      const std::size_t step = 1 + bytes.size() / 500;
      for (std::size_t length = 0; length < bytes.size(); length += step)
        target(std::string_view(bytes).substr(0, length));
    }
}

TEST(Corpus, IsTakenOrRefusedWithAnyByteWrong) {
  for (const auto& [name, target] : targets)
    for (std::string bytes : corpus(name)) {
      const std::size_t step = 1 + bytes.size() / 500;
      for (std::size_t i = 0; i < bytes.size(); i += step)
        for (const char wrong : {'\0', '\n', '9', '-', '\xff'}) {
          const char right = std::exchange(bytes[i], wrong);
          target(bytes);
          bytes[i] = right;
        }
    }
}

}  // namespace
}  // namespace bvlab::fuzz
