// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/records/record.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "build_facts.hpp"
#include "commit.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/records/node.hpp"

namespace bvlab {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n") == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + '"';
}

std::string line_of(const Row& row) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i ? "," : "") + quoted(row[i]);
  return line + '\n';
}

/// Of lines that have an end; whether all have.
std::pair<std::vector<Row>, bool> parse_csv(const std::string& text) {
  std::vector<Row> rows;
  Row row;
  std::string field;
  bool inside = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inside && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      field += c, ++i;
    else if (c == '"')
      inside = !inside;
    else if (!inside && (c == ',' || c == '\n')) {
      row.push_back(std::move(field));
      field.clear();
      if (c == '\n') rows.push_back(std::move(row)), row.clear();
    } else {
      field += c;
    }
  }
  return {std::move(rows), !inside && row.empty() && field.empty()};
}

std::string after_colon(const std::string& file, const std::string& key) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(key))
      if (const auto colon = line.find(':'); colon != line.npos)
        return line.substr(line.find_first_not_of(" \t", colon + 1));
  return "unknown";
}

std::string system_name() {
  std::ifstream lines("/etc/os-release");
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("PRETTY_NAME=")) return line.substr(13, line.size() - 14);
  return "unknown";
}

std::string now(const char* format) {
  const auto time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm date{};
  gmtime_r(&time, &date);
  char text[32];
  std::strftime(text, sizeof text, format, &date);
  return text;
}

/// null where it is unknown, as in a folder without its history.
nlohmann::ordered_json known(const std::string& commit) {
  return commit.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(commit);
}

nlohmann::ordered_json changes() {
  const std::string_view text = build_facts::changes;
  return text == "unknown" ? nlohmann::ordered_json() : nlohmann::ordered_json(text == "yes");
}

/// A record that stands in the repository can be made again: its commit names the program.
void refuse_with_changes(const std::filesystem::path& record) {
  if (std::string_view(build_facts::changes) != "yes") return;
  std::error_code error;
  const auto records = std::filesystem::weakly_canonical(build_facts::records, error);
  const auto folder = std::filesystem::weakly_canonical(record, error);
  const auto [end, within] =
      std::mismatch(records.begin(), records.end(), folder.begin(), folder.end());
  if (end == records.end())
    throw Unusable(record.string(),
                   "the program was built from a tree with changes: commit them and build, or give "
                   "--record a folder elsewhere");
}

std::string machine() {
  utsname kernel{};
  uname(&kernel);
  const nlohmann::ordered_json json = {{"node", node_name()},
                                       {"processor", after_colon("/proc/cpuinfo", "model name")},
                                       {"cores", std::thread::hardware_concurrency()},
                                       {"memory", after_colon("/proc/meminfo", "MemTotal")},
                                       {"system", system_name()},
                                       {"kernel", kernel.release},
                                       {"compiler", build_facts::compiler},
                                       {"flags", build_facts::flags},
                                       {"libraries", build_facts::libraries},
                                       {"bvlab", build_facts::version},
                                       {"date", now("%Y-%m-%dT%H:%M:%SZ")},
                                       {"commit", known(build_facts::commit)},
                                       {"changes", changes()}};
  return json.dump(2) + "\n";
}

/// Two runs at work on one record would undo each other's rows: the second waits until the first
/// has ended, however that ends. Where the file system has no locks there is none.
void hold_until_exit(const std::filesystem::path& record) {
  const int folder = open(record.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0 || flock(folder, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  std::fprintf(stderr, "%s: waiting for another run to end\n", one_line(record.string()).c_str());
  while (flock(folder, LOCK_EX) != 0 && errno == EINTR) {
  }
}

/// A record that was begun and refused, as for a mesh that there is not: of no use but to be begun
/// again.
bool is_without_rows(const std::filesystem::path& record) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(record)) {
    const auto name = entry.path().filename();
    if (name != "definition.toml" && name != "machine.json" && name != "command.txt") return false;
    ++files;
  }
  return files == 3;
}

}  // namespace

Table::Table(std::filesystem::path path, Row columns)
    : path_(std::move(path)), columns_(std::move(columns)) {
  if (!std::filesystem::exists(path_)) return;
  auto [rows, is_whole] = parse_csv(contents(path_));
  const std::size_t held = rows.empty() ? 0 : rows[0].size();
  if (held == 0 || held > columns_.size() ||
      !std::equal(rows[0].begin(), rows[0].end(), columns_.begin()))
    throw Unusable(path_.string(), "has other columns");
  if (!is_whole) throw Unusable(path_.string(), "is cut off: its last line has no end");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].size() != held)
      throw Unusable(path_.string(), "line " + std::to_string(i + 1) + " has " +
                                         std::to_string(rows[i].size()) + " fields, not " +
                                         std::to_string(held));
    rows[i].resize(columns_.size());
    rows_.push_back(std::move(rows[i]));
  }
}

void Table::forget(const Row& key) {
  std::erase_if(rows_, [&](const Row& row) {
    return std::equal(key.begin(), key.end(), row.begin(),
                      row.begin() + static_cast<std::ptrdiff_t>(key.size()));
  });
}

void Table::save() const {
  std::string text = line_of(columns_);
  for (const auto& row : rows_) text += line_of(row);
  write_whole(path_, text);
}

std::filesystem::path fresh_record(const std::filesystem::path& parent) {
  const std::string day = now("%Y-%m-%d");
  for (int n = 1;; ++n)
    if (const auto path = parent / (day + "." + std::to_string(n)); !std::filesystem::exists(path))
      return path;
}

void open_record(const std::filesystem::path& record, const std::string& definition,
                 const std::string& command) {
  refuse_with_changes(record);
  std::error_code error;
  std::filesystem::create_directories(record, error);
  if (error) throw Unusable(record.string(), "cannot be made: " + error.message());
  hold_until_exit(record);
  clear_left_behind(record);
  const auto held = record / "definition.toml";
  if (!std::filesystem::exists(held)) require_place("--record", held);
  const bool anew = std::filesystem::exists(held) && contents(held) != definition;
  if (anew && !is_without_rows(record))
    throw Unusable(record.string(), "is a record of another definition");
  const auto write = [&](const char* name, const std::string& text) {
    if (anew || !std::filesystem::exists(record / name)) write_whole(record / name, text);
  };
  write("definition.toml", definition);
  write("machine.json", machine());
  write("command.txt", command + "\n");
}

}  // namespace bvlab
