// SPDX-License-Identifier: BSD-3-Clause
/// toml++, without its assertions: version 3.3.0 asserts what a malformed file can make false, and
/// refuses the file by an exception where assertions are off.
#pragma once

#define TOML_ASSERT(condition) static_cast<void>(0)
#include <toml++/toml.h>

#include <optional>
#include <string>

#include "experiments/files/numbers.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {

/// What the readers of experiments and of studies have in common. Every complaint names the file
/// and the line.
class TomlReader {
 public:
  explicit TomlReader(const std::string& file) : file_(file) {}

 protected:
  [[noreturn]] void fail(const toml::source_region& where, const std::string& what) const {
    throw Unusable(file_, "line " + std::to_string(where.begin.line) + ": " + what);
  }
  /// A text or a number, as text.
  static std::optional<std::string> scalar(const toml::node& node) {
    if (const auto value = node.value_exact<std::string>()) return *value;
    if (const auto value = node.value_exact<std::int64_t>()) return text_of(*value);
    if (const auto value = node.value_exact<double>()) return text_of(*value);
    return std::nullopt;
  }
  unsigned repetitions(const toml::node& node) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > 1000)
      fail(node.source(), "repetitions must be a whole number from 1 to 1000");
    return static_cast<unsigned>(*value);
  }
  const toml::table& table(const toml::node& node, const char* what) const {
    if (const auto* table = node.as_table()) return *table;
    fail(node.source(), std::string(what) + " must be a table");
  }
  /// Of the record's files.
  void require_name(const std::string& name) const {
    if (name.empty() || name.find('/') != name.npos)
      throw Unusable(file_, "needs a name (without '/')");
  }

  const std::string& file_;
};

}  // namespace bvlab
