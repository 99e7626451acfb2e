// SPDX-License-Identifier: BSD-3-Clause
/// What is thrown when an argument or an input file cannot be used: the program prints its one
/// line and exits with 2.
#pragma once

#include <stdexcept>
#include <string>

namespace bvlab {

struct Unusable : std::runtime_error {
  using std::runtime_error::runtime_error;
  Unusable(const std::string& file, const std::string& what) : std::runtime_error(file + ": " + what) {}
};

}  // namespace bvlab
