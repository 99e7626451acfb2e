// SPDX-License-Identifier: BSD-3-Clause
/// What is thrown when an argument or an input file cannot be used: the program prints its one
/// line and exits with 2.
#pragma once

#include <stdexcept>
#include <string>

namespace bvlab {

/// The message on one line, and all of it, whatever the names and words that it quotes hold.
inline std::string one_line(std::string message) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return message;
}

struct Unusable : std::runtime_error {
  explicit Unusable(const std::string& what) : std::runtime_error(one_line(what)) {}
  Unusable(const std::string& file, const std::string& what) : Unusable(file + ": " + what) {}
};

}  // namespace bvlab
