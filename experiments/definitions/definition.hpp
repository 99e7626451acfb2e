// SPDX-License-Identifier: BSD-3-Clause
// The sample is TOML line by line, and kept so:
// clang-format off
/// An experiment as it is written down: parameters that stay, axes that vary, and what is wanted of
/// every cell of their product.
///
///     name = "nine-bunnies"
///     description = "one line"
///     repetitions = 3                # timed runs of each cell, interleaved
///     # beside the rest: see coherence.hpp, times of single frames (p99_ns), see predict.hpp
///     measures = ["coherence", "best rebuilds", "frames", "predictions"]
///
///     [parameters]                   # see `bvlab list parameters`; what is not set has its default
///     mesh = "bunny"
///     configuration = "recommended"  # sets the parameters that say what is compared, and how
///
///     [[axis]]                       # one parameter
///     name = "seed"
///     values = [1, 2, 3]
///
///     [[axis]]                       # several parameters at once, under a name
///     name = "reading"
///     [[axis.value]]
///     name = "one at a time"
///     moving = 1
///
///     [series]                       # cells to write down frame by frame as well
///     seed = 1
///     until = 1000                   # this many frames of each, at most
///
///     [[figure]]                     # what plots/draw shows of it: see README.md beside this file
///     name = "tests"
///     x = "seed"
// clang-format on
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bvlab {

/// Parameter names and values in the order of `parameters`, or a subset of them.
using Setting = std::pair<std::string, std::string>;
using Settings = std::vector<Setting>;

struct Definition {
  struct Value {
    std::string label;
    Settings settings;
  };
  struct Axis {
    std::string name;
    bool is_parameter = true;  ///< false: `name` labels settings of several parameters
    std::vector<Value> values;
  };
  std::string name, description;
  unsigned repetitions = 1;
  Settings parameters;
  std::vector<Axis> axes;
  Settings series;  ///< labels or parameters that a cell must have to be written frame by frame
  bool has_series = false;
  std::size_t series_until = static_cast<std::size_t>(-1);  ///< frames of each
  std::set<std::string> measures;                           ///< of every trace, for every volume
  bool has_figures = false;                                 ///< see figures_checked.hpp
  std::string text;                                         ///< the file as it was
  std::string file;                                         ///< for messages
};

/// One point of the product: every parameter, and the labels of the axes that are no parameters.
struct Cell {
  Settings parameters;
  Settings labels;

  /// Of a parameter or a label; empty where there is none.
  const std::string& operator[](std::string_view name) const;
};

/// A parameter of an experiment: of its scene or of its variant.
struct Parameter {
  std::string name, fallback, what;
};

/// All there are, in the order of a record's columns: the one source of defaults, of
/// `bvlab list parameters`, and of the page beside this file.
const std::vector<Parameter>& parameters();

/// They with their defaults.
const Settings& default_parameters();

/// No experiment has more; what multiplies into more is a slip of the pen, and is refused before
/// memory runs out.
inline constexpr std::size_t most_cells = 100000;

/// Calls `check`. What it refuses without naming the file is refused with the file's name: names
/// are looked up by those who do not know it.
void name_file(const std::string& file, const std::function<void()>& check);

/// Refuses with Unusable what the parser of TOML does not bear: too many dots, letters beyond ASCII
/// outside of strings.
void check_text(const std::string& text, const std::string& name);

/// Throws Unusable naming the file and the line or the key.
Definition read_definition(const std::string& path);
Definition parse_definition(const std::string& text, const std::string& name);

/// The first axis varies slowest.
std::vector<Cell> cells_of(const Definition& definition);

}  // namespace bvlab
