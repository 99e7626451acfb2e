// SPDX-License-Identifier: BSD-3-Clause
/// golden_table DEFINITION.toml FRAMES [AXIS=VALUE;VALUE...]...: what the cells of a definition
/// (those that have one of the values on each axis named) count and answer, as CSV on standard
/// output, after a line that says how many lanes a register has here: steps of several
/// lanes test more than those of one before a query ends. The values of the last axis stand beside each other, each with its "n_u n_v
/// n_p"; a line has the values of all the other axes, the hits, and a hash of the answers (several
/// where columns differ). A cell is "-" where the program refuses it, empty where its volume or
/// strategy was not compiled or its meshes are absent. What is recommended is left out: it is one
/// of the candidates.
#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "experiments/definitions/definition.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/studies/cells.hpp"
#include "experiments/studies/side_by_side.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {
namespace {

/// FNV-1a.
struct Hash {
  std::uint64_t value = 0xcbf29ce484222325;
  void add(std::string_view bytes) {
    for (const char byte : bytes)
      value = (value ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  }
};

/// Distances to six digits, since strategies and processors may differ in their rounding.
std::string hash_of(const ReplayResult& result) {
  Hash hash;
  char text[32];
  for (const std::uint8_t yes : result.touching) hash.add(yes ? "1" : "0");
  for (const double distance : result.distances)
    hash.add({text, static_cast<std::size_t>(std::snprintf(text, sizeof text, "%.6g ", distance))});
  for (const auto& contact : result.contacts)
    for (const std::uint32_t number : contact) hash.add(std::to_string(number) + ' ');
  std::snprintf(text, sizeof text, "%08" PRIx64, hash.value >> 32);
  return text;
}

struct Found {
  std::string counts, answers;  ///< answers: hits and hash
};

Found found(const Prepared& ready, const Variant& variant) {
  Found found;
  if (!has(volumes(), variant.volume) || !has(strategies(), variant.strategy)) return found;
  try {
    check(variant);
  } catch (const Unusable&) {
    return {"-", ""};
  }
  ReplayOptions options;
  options.count = Count::on;
  const ReplayResult result = replay(ready.meshes, ready.trace, variant, options);
  found.counts = std::to_string(result.n_u) + ' ' + std::to_string(result.n_v) + ' ' +
                 std::to_string(result.n_p);
  found.answers = std::to_string(result.hits) + ' ' + hash_of(result);
  return found;
}

std::optional<Prepared> prepared_if_there(const Cell& cell) {
  try {
    if (cell["mesh"] == "bunny" && named_mesh("bunny", 500).name != "bunny") return {};
    return prepared(cell);
  } catch (const Unusable& fault) {
    std::fprintf(stderr, "golden_table: left out: %s\n", fault.what());
    return {};
  }
}

std::vector<Found> found_of(const std::vector<Cell>& cells) {
  std::vector<Found> all(cells.size());
  const auto traces = traces_of(cells);
  side_by_side(traces.size(), cores_allowed(), [&](std::size_t t) {
    const auto ready = prepared_if_there(cells[traces[t][0]]);
    if (!ready) return;
    for (const std::size_t i : traces[t]) all[i] = found(*ready, variant_of(cells[i]));
  });
  return all;
}

void print(const Definition& definition, const std::vector<Cell>& cells,
           const std::vector<Found>& found) {
  const auto& axes = definition.axes;
  std::printf("# %d lanes\n", native_width<float>);
  for (std::size_t i = 0; i + 1 < axes.size(); ++i) std::printf("%s;", axes[i].name.c_str());
  std::printf("hits answers");
  std::vector<std::string> columns;
  for (const auto& cell : cells)
    if (const auto& label = cell[axes.back().name];
        std::find(columns.begin(), columns.end(), label) == columns.end())
      columns.push_back(label), std::printf(";%s", label.c_str());
  std::puts("");
  for (std::size_t first = 0; first < cells.size(); first += columns.size()) {
    std::string answers, counts;
    for (std::size_t i = first; i < first + columns.size(); ++i) {
      counts += ';' + found[i].counts;
      if (answers.find(found[i].answers) == answers.npos)
        answers += (answers.empty() ? "" : " / ") + found[i].answers;
    }
    for (std::size_t i = 0; i + 1 < axes.size(); ++i)
      std::printf("%s;", cells[first][axes[i].name].c_str());
    std::printf("%s%s\n", answers.c_str(), counts.c_str());
  }
}

/// `chosen`: AXIS=VALUE;VALUE, of an axis before the last one, so that lines stay whole.
bool is_among(const Cell& cell, const std::string& chosen) {
  const auto equals = chosen.find('=');
  if (equals == chosen.npos) throw Unusable(chosen + ": not of the form AXIS=VALUE;VALUE");
  const std::string& label = cell[chosen.substr(0, equals)];
  return (';' + chosen.substr(equals + 1) + ';').find(';' + label + ';') != chosen.npos;
}

void run(const char* file, const char* frames, const std::vector<std::string>& choices) {
  const Definition definition = read_definition(file);
  std::vector<Cell> cells = cells_of(definition);
  std::erase_if(cells, [&](const Cell& cell) {
    return !cell["configuration"].empty() ||
           !std::all_of(choices.begin(), choices.end(),
                        [&](const std::string& chosen) { return is_among(cell, chosen); });
  });
  for (Cell& cell : cells)
    for (auto& [name, value] : cell.parameters)
      if (name == "frames") value = frames;
  print(definition, cells, found_of(cells));
}

}  // namespace
}  // namespace bvlab

int main(int count, char** words) {
  if (count < 3) {
    std::fprintf(stderr, "usage: golden_table DEFINITION.toml FRAMES [AXIS=VALUE;VALUE...]...\n");
    return 2;
  }
  try {
    bvlab::run(words[1], words[2], {words + 3, words + count});
  } catch (const bvlab::Unusable& fault) {
    std::fprintf(stderr, "golden_table: %s\n", fault.what());
    return 2;
  }
}
