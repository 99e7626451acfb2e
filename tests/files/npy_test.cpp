// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/npy.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

constexpr std::size_t poses[] = {any_length, any_length, 7};

std::string bytes_of(std::span<const std::size_t> shape, std::span<const double> data) {
  return npy_header<double>(shape) +
         std::string(reinterpret_cast<const char*>(data.data()), data.size_bytes());
}

std::string message_of(const std::string& bytes) {
  try {
    parse_npy<double>(bytes, "poses.npy", poses);
    return "";
  } catch (const Unusable& error) {
    return error.what();
  }
}

TEST(Npy, WhatIsWrittenIsRead) {
  const std::size_t shape[] = {2, 1, 7};
  std::vector<double> data(14);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = 0.1 * static_cast<double>(i);
  const auto path = std::filesystem::temp_directory_path() / "bvlab_npy_test.npy";
  write_npy<double>(path, shape, data);
  const auto array = read_npy<double>(path, poses);
  std::filesystem::remove(path);
  EXPECT_EQ(array.shape, std::vector<std::size_t>({2, 1, 7}));
  EXPECT_EQ(array.data, data);
  EXPECT_EQ(npy_header<double>(shape).size() % 64, 0u);
}

TEST(Npy, NoFramesIsLegal) {
  const std::size_t shape[] = {0, 9, 7};
  EXPECT_EQ(parse_npy<double>(bytes_of(shape, {}), "poses.npy", poses).data.size(), 0u);
}

TEST(Npy, EachFaultIsNamed) {
  const std::size_t shape[] = {1, 1, 7};
  const std::vector<double> data(7, 1.0);
  const std::string good = bytes_of(shape, data);
  EXPECT_EQ(message_of(good), "");
  EXPECT_EQ(message_of("hello"), "poses.npy: not a .npy file");
  EXPECT_EQ(message_of(good.substr(0, 40)), "poses.npy: truncated .npy header");
  EXPECT_EQ(message_of(good.substr(0, good.size() - 8)),
            "poses.npy: truncated: holds 6 of 7 values");
  EXPECT_EQ(message_of(good + "x"), "poses.npy: trailing bytes");
  const std::size_t six[] = {1, 1, 6};
  EXPECT_EQ(message_of(bytes_of(six, std::span(data).first(6))),
            "poses.npy: has shape (1, 1, 6) where (*, *, 7) is needed");
  std::string other = good;
  other.replace(other.find("<f8"), 3, "<i8");
  EXPECT_EQ(message_of(other), "poses.npy: holds '<i8' where '<f8' is needed");
  other = good;
  other.replace(other.find("False"), 5, "True ");
  EXPECT_EQ(message_of(other), "poses.npy: is in Fortran order; C order is needed");
  const std::size_t huge[] = {std::size_t{1} << 40, std::size_t{1} << 40, 7};
  EXPECT_EQ(message_of(bytes_of(huge, data)), "poses.npy: truncated: shape too large");
  EXPECT_THROW(read_npy<double>("/nowhere/poses.npy", poses), Unusable);
}

}  // namespace
}  // namespace bvlab
