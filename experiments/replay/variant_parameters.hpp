// SPDX-License-Identifier: BSD-3-Clause
/// The parameters of a variant, each declared once: from here come options of the command line,
/// parameters of a definition with their defaults, columns of a record, totals, and what a
/// configuration excludes.
#pragma once

#include <string_view>
#include <vector>

#include "experiments/files/numbers.hpp"
#include "experiments/replay/replay.hpp"

namespace bvlab {

/// Whether a named configuration sets a parameter, which then cannot be set beside it.
enum class SetBy { configuration, user };

/// Calls visit(name, value, what, by) for each parameter of a variant, const or not, in the order
/// of the columns of a record.
template <class V, class Visit>
void visit_parameters(V&& variant, Visit&& visit) {
  constexpr auto configuration = SetBy::configuration, user = SetBy::user;
  visit("volume", variant.volume, "see `bvlab list volumes`", configuration);
  visit("strategy", variant.strategy, "see `bvlab list strategies`; name or name:parameter",
        configuration);
  visit("query", variant.query, "see `bvlab list queries`", user);
  visit("build", variant.build, "how trees are built; see `bvlab list builds`", configuration);
  visit("leaf_size", variant.leaf_size,
        "most triangles in a leaf; with kernel siblings at most as many as its lanes, with mixed 4",
        configuration);
  visit("fit", variant.fit,
        "how volumes are fitted: published, or tight where they have such a fit", configuration);
  visit("precision", variant.precision, "of triangle tests; see `bvlab list precisions`", user);
  visit("relative_error", variant.relative_error,
        "largest relative error of a distance; it is not below the exact one by more than rounding",
        user);
  visit("fan_out", variant.fan_out,
        "most children of a node: 2, 4, 8 or 16; in a definition also native, a register's lanes",
        configuration);
  visit("frame", variant.frame,
        "frame in which volumes are compared: world or body; see `bvlab list frames`",
        configuration);
  visit("kernel", variant.kernel, "how lanes are filled; see `bvlab list kernels`", configuration);
}

/// The names of the parameters that a configuration sets.
inline std::vector<std::string_view> set_by_configuration() {
  std::vector<std::string_view> names;
  visit_parameters(Variant{}, [&](std::string_view name, const auto&, std::string_view, SetBy by) {
    if (by == SetBy::configuration) names.push_back(name);
  });
  return names;
}

}  // namespace bvlab
