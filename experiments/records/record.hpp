// SPDX-License-Identifier: BSD-3-Clause
/// A record: a folder that holds what an experiment found, with the machine, the command and the
/// definition beside it. Tables are written whole or not at all, so a run that is killed leaves
/// what it had finished.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bvlab {

using Row = std::vector<std::string>;

/// A CSV file with named columns.
class Table {
 public:
  /// Reads the file if it is there; it must have these columns, or Unusable is thrown. The last of
  /// them may be missing, as in a record from before there were such: then they are empty. Unusable
  /// is thrown, too, where its last line has no end.
  Table(std::filesystem::path path, Row columns);

  const Row& columns() const { return columns_; }
  const std::vector<Row>& rows() const { return rows_; }
  void add(Row row) { rows_.push_back(std::move(row)); }
  /// Drops the rows that begin with these fields.
  void forget(const Row& key);
  void save() const;

 private:
  std::filesystem::path path_;
  Row columns_;
  std::vector<Row> rows_;
};

/// `<parent>/<date>.<n>`: the first n that is free today.
std::filesystem::path fresh_record(const std::filesystem::path& parent);

/// Writes definition.toml, machine.json and command.txt unless they are there. A record of another
/// definition is refused with Unusable (unless nothing but these three is in it, as after a run
/// that was refused: then it is begun again), and so is one in the repository's experiments/record
/// while the program was built from a tree with changes. Waits while another process has it open.
void open_record(const std::filesystem::path& record, const std::string& definition,
                 const std::string& command);

}  // namespace bvlab
