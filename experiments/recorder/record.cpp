// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recorder/record.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "build_facts.hpp"
#include "commit.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/recorder/node.hpp"

namespace bvlab {
namespace {

constexpr char unfinished_file[] = "unfinished.json";

/// Empty where the file cannot be read.
std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n\r") == std::string::npos) return field;
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
std::pair<std::vector<Row>, bool> parse_csv(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
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

/// What the line of that key says, without quotes: "key : value" or KEY="value".
std::string value_in(const std::string& file, const std::string& key) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (const auto at = line.find_first_of(":="); line.starts_with(key) && at != line.npos) {
      const auto begin = line.find_first_not_of(" \t\"", at + 1);
      if (begin == line.npos) break;
      return line.substr(begin, line.find_last_not_of('"') + 1 - begin);
    }
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

/// What the steady clock, by which frames are timed, tells: "processor" under
/// experiments/processor_time.c, else "wall". The raw clock runs at least nearly as fast as wall
/// time since the machine was started.
std::string clock_name() {
  timespec steady{}, raw{};
  clock_gettime(CLOCK_MONOTONIC, &steady);
  clock_gettime(CLOCK_MONOTONIC_RAW, &raw);
  return steady.tv_sec < raw.tv_sec / 2 ? "processor" : "wall";
}

/// null where it is unknown, as in a folder without its history.
nlohmann::ordered_json known(const std::string& commit) {
  return commit.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(commit);
}

nlohmann::ordered_json changes() {
  const std::string_view text = build_facts::changes;
  return text == "unknown" ? nlohmann::ordered_json() : nlohmann::ordered_json(text == "yes");
}

nlohmann::ordered_json outside();

/// A record in the repository can be made again: its commit names the program.
void refuse_with_changes(const std::filesystem::path& record) {
  if (std::string_view(build_facts::changes) != "yes") return;
  std::error_code error;
  const auto records = std::filesystem::weakly_canonical(build_facts::records, error);
  const auto folder = std::filesystem::weakly_canonical(record, error);
  const auto [end, within] =
      std::mismatch(records.begin(), records.end(), folder.begin(), folder.end());
  if (end == records.end())
    throw Unusable(record.string(),
                   std::string("the program was built from a tree with ") +
                       (outside().empty() ? "changes: commit them and build"
                                          : "code from outside: build without it") +
                       ", or give --record a folder elsewhere");
}

/// Code that the program has from outside of its tree: which, and what it was when it was compiled.
nlohmann::ordered_json outside() {
  auto list = nlohmann::ordered_json::array();
  for (const auto& file : build_facts::outside)
    if (*file.path) list.push_back({{"path", file.path}, {"sha256", file.sha256}});
  return list;
}

nlohmann::ordered_json machine() {
  utsname kernel{};
  uname(&kernel);
  nlohmann::ordered_json json = {{"node", node_name()},
                                 {"processor", value_in("/proc/cpuinfo", "model name")},
                                 {"cores", std::thread::hardware_concurrency()},
                                 {"memory", value_in("/proc/meminfo", "MemTotal")},
                                 {"system", value_in("/etc/os-release", "PRETTY_NAME")},
                                 {"kernel", kernel.release},
                                 {"compiler", build_facts::compiler},
                                 {"flags", build_facts::flags},
                                 {"libraries", build_facts::libraries},
                                 {"bvlab", build_facts::version},
                                 {"clock", clock_name()},
                                 {"date", now("%Y-%m-%dT%H:%M:%SZ")},
                                 {"commit", known(build_facts::commit)},
                                 {"changes", changes()}};
  if (auto files = outside(); !files.empty()) json["outside"] = std::move(files);
  return json;
}

/// What a program is and by which clock it times, beside the machine that it runs on.
constexpr const char* of_program[] = {"compiler", "flags",  "libraries", "bvlab",
                                      "clock",    "commit", "changes",   "outside"};

/// The machine.json of a record that this program goes on with: an entry under `later` holds every
/// fact of the program that changed. Changes of any of the programs are changes of the record.
std::string continued(const std::string& held, const std::string& command) {
  auto json = nlohmann::ordered_json::parse(held, nullptr, false);
  if (!json.is_object()) return held;
  const auto now = machine();
  const auto& last = json.contains("later") && !json["later"].empty() ? json["later"].back() : json;
  nlohmann::ordered_json later;
  for (const char* key : of_program) {
    const auto before = last.contains(key) ? last[key] : json.value(key, nlohmann::ordered_json());
    const auto after = now.value(key, nlohmann::ordered_json());
    if (before != after) later[key] = after;
  }
  if (later.empty()) return held;
  later["date"] = now["date"], later["command"] = command;
  json["later"].push_back(later);
  if (now["changes"] == true) json["changes"] = true;
  return json.dump(2) + "\n";
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
  if (!is_whole && !std::filesystem::exists(path_.parent_path() / unfinished_file))
    throw Unusable(path_.string(), "is cut off: its last line has no end");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].size() != held)
      throw Unusable(path_.string(), "line " + std::to_string(i + 1) + " has " +
                                         std::to_string(rows[i].size()) + " fields, not " +
                                         std::to_string(held));
    rows[i].resize(columns_.size());
    rows_.push_back(std::move(rows[i]));
  }
  is_on_disk_ = is_whole && held == columns_.size();
}

void Table::append(std::vector<Row> rows) {
  const bool was_on_disk = is_on_disk_;
  std::string lines;
  for (Row& row : rows) {
    lines += line_of(row);
    rows_.push_back(std::move(row));
  }
  is_on_disk_ = false;
  if (!was_on_disk) return save();
  append_to(path_, lines);
  is_on_disk_ = true;
}

bool Table::has(const Row& key) const {
  return std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    return std::equal(key.begin(), key.end(), row.begin());
  });
}

void Table::forget(const Row& key) {
  const std::size_t gone = std::erase_if(
      rows_, [&](const Row& row) { return std::equal(key.begin(), key.end(), row.begin()); });
  if (gone > 0) is_on_disk_ = false;
}

void Table::sort(const std::function<bool(const Row&, const Row&)>& before) {
  if (std::is_sorted(rows_.begin(), rows_.end(), before)) return;
  std::stable_sort(rows_.begin(), rows_.end(), before);
  is_on_disk_ = false;
}

void Table::save() {
  if (is_on_disk_) return;
  std::string text = line_of(columns_);
  for (const auto& row : rows_) text += line_of(row);
  write_whole(path_, text);
  is_on_disk_ = true;
}

void Table::discard() {
  std::error_code error;
  std::filesystem::remove(path_, error);
  rows_.clear(), is_on_disk_ = false;
}

void mark_unfinished(const std::filesystem::path& record, std::string_view what, std::size_t done,
                     std::size_t all) {
  const nlohmann::ordered_json json = {{"what", what}, {"done", done}, {"all", all}};
  write_whole(record / unfinished_file, json.dump() + "\n");
}

void mark_finished(const std::filesystem::path& record) {
  std::error_code error;
  std::filesystem::remove(record / unfinished_file, error);
}

std::filesystem::path fresh_record(const std::filesystem::path& parent) {
  const std::string day = now("%Y-%m-%d");
  for (int n = 1;; ++n)
    if (const auto path = parent / (day + "." + std::to_string(n)); !std::filesystem::exists(path))
      return path;
}

RecordLock open_record(const std::filesystem::path& record, const std::string& definition,
                       const std::string& command, const Extends& extends,
                       const std::function<void()>& waiting) {
  refuse_with_changes(record);
  RecordLock lock(record, waiting);
  clear_left_behind(record);
  const auto held = record / "definition.toml";
  if (!std::filesystem::exists(held)) require_place("--record", held);
  const bool is_other = std::filesystem::exists(held) && contents(held) != definition;
  const bool anew = is_other && is_without_rows(record);
  if (is_other && !anew) {
    try {
      extends(contents(held), definition);
    } catch (const Unusable& fault) {
      throw Unusable(record.string(),
                     std::string("is a record of another definition: ") + fault.what());
    }
  }
  const auto write = [&](const char* name, const std::string& text) {
    if (!std::filesystem::exists(record / name) || contents(record / name) != text)
      write_whole(record / name, text);
  };
  const auto before = [&](const char* name) {
    return anew || !std::filesystem::exists(record / name) ? "" : contents(record / name);
  };
  const std::string machines = before("machine.json"), commands = before("command.txt");
  write("definition.toml", definition);
  write("machine.json", machines.empty() ? machine().dump(2) + "\n" : continued(machines, command));
  const bool is_known = ("\n" + commands).find("\n" + command + "\n") != commands.npos;
  if (commands.empty() || (is_other && !is_known)) write("command.txt", commands + command + "\n");
  return lock;
}

bool is_without_rows(const std::filesystem::path& record) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(record)) {
    const auto name = entry.path().filename();
    if (name == unfinished_file) continue;
    if (name != "definition.toml" && name != "machine.json" && name != "command.txt") return false;
    ++files;
  }
  return files == 3;
}

std::string program_version() {
  const std::string commit = build_facts::commit, changes = build_facts::changes;
  std::string said = std::string("bvlab ") + build_facts::version;
  if (!commit.empty())
    said += ", commit " + commit.substr(0, 12) + (changes == "yes" ? " with changes" : "");
  return said + ", " + build_facts::compiler + " " + build_facts::flags;
}

}  // namespace bvlab
