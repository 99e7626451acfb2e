// SPDX-License-Identifier: BSD-3-Clause
/// The tables of an experiment's record: what their rows begin with, and the columns behind that.
#pragma once

#include <filesystem>
#include <optional>

#include "experiments/definitions/definition.hpp"
#include "experiments/peers/disagreements.hpp"
#include "experiments/recorder/record.hpp"
#include "experiments/replay/coherence.hpp"

namespace bvlab {

/// What tells the rows of a table apart: all settings of a cell; what varies alone, since a series
/// is long; or what a front depends on, which is the trace and a part of the variant.
enum class By { cell, axes, front };

/// The columns of a table behind those that say what was run.
struct TableForm {
  const char* ending;  ///< of the file's name
  By by;
  Row measured;
};
namespace forms {
extern const TableForm rows, counted, frames, disagreements, coherence, predictions;
}

/// The values, or the names, of what rows of a cell begin with.
Row key_of(By by, const Definition& definition, const Cell& cell);
Row names_of(By by, const Definition& definition, const Cell& cell);

/// One of an experiment's tables.
class ExperimentTable : public Table {
 public:
  /// `any` is one of the definition's cells.
  ExperimentTable(const std::filesystem::path& record, const Definition& definition,
                  const Cell& any, const TableForm& form);

  By by() const { return by_; }
  /// What rows of the cell begin with.
  Row key(const Cell& cell) const { return key_of(by_, definition_, cell); }
  /// What the row begins with.
  Row key(const Row& row) const { return Row(row.begin(), row.begin() + keys_); }
  /// What was measured, from the column of that place among those of `measured` on.
  Row::const_iterator measured(const Row& row, std::ptrdiff_t column = 0) const {
    return row.begin() + keys_ + column;
  }
  /// Puts rows in the place of those that begin with the key. A run that was killed between two
  /// files has left its rows in one of them.
  void replace(const Row& key, std::vector<Row> rows);

 private:
  const Definition& definition_;
  By by_;
  std::ptrdiff_t keys_;
};

/// Rows of a cell that begin with the key: of each frame, or of what a peer answers otherwise.
std::vector<Row> series_rows(const Row& key, const Definition& definition,
                             const ReplayResult& counted);
std::vector<Row> disagreement_rows(const Row& key, const std::vector<Disagreement>& all);

/// A row of the table of coherence.
Row coherence_row(Row key, const CoherenceSums& sums, const std::optional<BestRebuilds>& best);

/// Whether the definition wants the cell frame by frame.
bool wants_series(const Definition& definition, const Cell& cell);

/// Whether it wants the table of coherence, or best rebuilds in it.
bool measures_coherence(const Definition& definition);
bool measures_best_rebuilds(const Definition& definition);

/// Throws Unusable where a label, which has a column of its own, is named as another column is.
void check_axis_name(const Definition::Axis& axis);

}  // namespace bvlab
