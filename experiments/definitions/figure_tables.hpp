// SPDX-License-Identifier: BSD-3-Clause
/// The [[figure]] tables of a definition. plots/draw reads them (plots/figures.py says what they
/// mean); here it is checked that it will be able to, before hours of measuring.
#pragma once

#include <toml++/toml.h>

#include <string>

namespace bvlab {

/// Throws Unusable naming the file, the line, and what there is.
void check_figures(const toml::node& figures, const std::string& file);

}  // namespace bvlab
