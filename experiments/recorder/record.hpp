// SPDX-License-Identifier: BSD-3-Clause
/// A record: a folder that holds what an experiment found, with the machine, the command and the
/// definition beside it. A row is on the disk as soon as it is known, and a finished table is
/// written whole or not at all: a run that is killed loses the row that it was at.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/files/numbers.hpp"
#include "experiments/recorder/record_lock.hpp"

namespace bvlab {

using Row = std::vector<std::string>;

/// Adds fields to a row: texts as they are, numbers with the digits that give them again.
template <class... Fields>
void add_to(Row& row, const Fields&... fields) {
  (row.push_back(text_of(fields)), ...);
}

/// A CSV file with named columns.
class Table {
 public:
  /// Reads the file if it is there; it must have these columns, or Unusable is thrown. The last of
  /// them may be missing, as in a record from before there were such: then they are empty. A last
  /// line without an end is left out where the record is unfinished, since its writer was killed;
  /// elsewhere Unusable is thrown.
  Table(std::filesystem::path path, Row columns);

  const Row& columns() const { return columns_; }
  const std::vector<Row>& rows() const { return rows_; }
  void add(Row row) { rows_.push_back(std::move(row)), is_on_disk_ = false; }
  /// Adds the rows, and writes them behind those of the file: O(rows), however many there are.
  void append(std::vector<Row> rows);
  /// Whether rows begin with these fields.
  bool has(const Row& key) const;
  /// Drops the rows that begin with these fields.
  void forget(const Row& key);
  /// Puts the rows into an order; equal rows keep their order.
  void sort(const std::function<bool(const Row&, const Row&)>& before);
  /// Anew, unless the file holds these rows already.
  void save();
  /// Removes the file.
  void discard();

 private:
  std::filesystem::path path_;
  Row columns_;
  std::vector<Row> rows_;
  bool is_on_disk_ = false;  ///< the file holds exactly these rows and columns
};

/// While rows are missing a record holds unfinished.json, which says how many of how many parts are
/// there, and what they are ("rows", "parts"): figures of it say so.
void mark_unfinished(const std::filesystem::path& record, std::string_view what, std::size_t done,
                     std::size_t all);
void mark_finished(const std::filesystem::path& record);

/// `<parent>/<date>.<n>`: the first n that is free today.
std::filesystem::path fresh_record(const std::filesystem::path& parent);

/// Throws Unusable where a record of the first definition cannot go on as one of the second.
using Extends = std::function<void(const std::string& held, const std::string& definition)>;

/// Writes definition.toml, machine.json and command.txt unless they are there. A record goes on
/// with a definition that extends its own, which is then replaced; any other is refused with
/// Unusable (unless the record has no rows, as after a run that was refused: then it is begun
/// again). So is a record in the repository's experiments/record while the program was
/// built from a tree with changes, or with code from outside of it. What goes on with a record by
/// another program or command is added to both files. `waiting` is as for RecordLock.
[[nodiscard]] RecordLock open_record(const std::filesystem::path& record,
                                     const std::string& definition, const std::string& command,
                                     const Extends& extends, const std::function<void()>& waiting);

/// Whether nothing is there but what a run writes before its first row: of no use, but to be begun
/// again.
bool is_without_rows(const std::filesystem::path& record);

/// The program that makes records: its version, commit and compiler, in one line.
std::string program_version();

}  // namespace bvlab
