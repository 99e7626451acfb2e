// SPDX-License-Identifier: BSD-3-Clause
/// The [[figure]] tables of a definition. plots/draw reads them (README.md beside this file says
/// what they mean); here it is checked that it will be able to, before hours of measuring.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "experiments/definitions/toml.hpp"

namespace bvlab {

struct FigureTable {
  std::string name;
  std::map<std::string, std::string> keys;  ///< but `where`
  std::vector<std::string> where;
  std::size_t line = 0;

  /// Empty where there is none.
  const std::string& operator[](const std::string& key) const;
};

/// Throws Unusable naming the file, the line, and what there is.
std::vector<FigureTable> read_figures(const toml::node& figures, const std::string& file);

/// What a record will hold, as far as it is known before it is made.
struct DrawnColumns {
  /// What varies at once: one axis, by its name, and all columns that it sets.
  struct Axis {
    std::string name;
    std::set<std::string> columns;
  };
  std::vector<std::string> record, frames;              ///< columns of the tables
  std::map<std::string, std::set<std::string>> values;  ///< of columns of which all are known
  std::vector<Axis> axes;                               ///< of several values, but seeds
  std::set<std::string> fixed_in_frames;                ///< by [series]
};

/// Throws Unusable, as above, for a figure that names a column or a value that there will not be,
/// or that leaves an axis neither named nor fixed.
void check_figures(const std::vector<FigureTable>& figures, const DrawnColumns& columns,
                   const std::string& file);

}  // namespace bvlab
