// SPDX-License-Identifier: BSD-3-Clause
/// The program's options as keyword arguments, with its defaults and its refusals.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>

#include "experiments/replay/replay.hpp"

namespace bvlab {

namespace py = pybind11;

/// As in Python's signatures, one name after the other. What a configuration sets is None where it
/// was not said: one that says the default is refused beside a configuration, too.
struct VariantWords {
  std::optional<std::string> volume{}, strategy{};
  std::string query;
  std::optional<std::uint32_t> fan_out{};
  std::optional<std::string> frame{}, kernel{}, configuration{}, build{};
  std::optional<std::uint32_t> leaf_size{};
  std::optional<std::string> fit{};
  std::string precision;
  double relative_error;

  /// The first of what a configuration sets that was said; null where none was.
  const char* said() const {
    for (const auto& [name, is_said] :
         {std::pair("volume", volume.has_value()), std::pair("strategy", strategy.has_value()),
          std::pair("fan_out", fan_out.has_value()), std::pair("frame", frame.has_value()),
          std::pair("kernel", kernel.has_value()), std::pair("build", build.has_value()),
          std::pair("leaf_size", leaf_size.has_value()), std::pair("fit", fit.has_value())})
      if (is_said) return name;
    return nullptr;
  }
};

/// The variant that was asked for, checked. Throws Unusable.
Variant variant_from(const VariantWords& words);

/// As the program's --threads. Throws Unusable.
void check_threads(int threads);

/// The source of defaults in Python's signatures.
inline Variant default_variant() { return {}; }

}  // namespace bvlab
