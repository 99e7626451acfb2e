// SPDX-License-Identifier: BSD-3-Clause
/// The program's options as keyword arguments, with its defaults and its refusals.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "experiments/replay/replay.hpp"

namespace bvlab {

namespace py = pybind11;

/// As in Python's signatures, one name after the other.
struct VariantWords {
  std::string volume, strategy, query;
  std::optional<std::uint32_t> fan_out;
  std::optional<std::string> frame;
  std::string kernel;
  std::optional<std::string> configuration;
  std::string build;
  std::uint32_t leaf_size;
  std::string fit, precision;
  double relative_error;
};

/// The variant that was asked for, checked. Throws Unusable.
Variant variant_from(const VariantWords& words);

/// As the program's --threads. Throws Unusable.
void check_threads(int threads);

/// The source of defaults in Python's signatures.
inline Variant default_variant() { return {}; }

}  // namespace bvlab
