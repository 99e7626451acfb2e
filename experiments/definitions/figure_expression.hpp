// SPDX-License-Identifier: BSD-3-Clause
/// The expressions of figures: what a definition can be refused for before it is run. They are
/// computed by plots/bvlab_plots/expression.py.
#pragma once

#include <string>
#include <vector>

namespace bvlab {

/// The names of columns in an expression: not what stands in quotes, nor the letters of numbers.
std::vector<std::string> names_in(const std::string& text);

/// What keeps a text from being an expression: values, compared or joined by + - * / ** and or,
/// with `not`, a minus sign, and parentheses. "" where nothing does.
std::string fault_in(const std::string& text);

}  // namespace bvlab
