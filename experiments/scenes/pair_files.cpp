// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/pair_files.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

enum class Repeats : std::uint8_t { allowed, refused };

std::vector<ObjectPair> pairs_from(const NamedNumbers& rows, std::size_t objects, Repeats repeats) {
  std::vector<ObjectPair> pairs;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> seen;
  for (std::size_t row = 0; 2 * row < rows.values.size(); ++row) {
    const auto refuse = [&](const std::string& what) {
      throw Unusable(rows.name, "row " + std::to_string(row) + ": " + what);
    };
    const auto object = [&](std::int64_t number) {
      if (number < 0 || static_cast<std::uint64_t>(number) >= objects)
        refuse("no object " + std::to_string(number) + "; there are " + std::to_string(objects));
      return static_cast<std::uint32_t>(number);
    };
    const auto [i, j] =
        std::minmax({object(rows.values[2 * row]), object(rows.values[2 * row + 1])});
    if (i == j) refuse("object " + std::to_string(i) + " with itself");
    if (repeats == Repeats::refused) {
      const auto [first, fresh] = seen.try_emplace({i, j}, row);
      if (!fresh) refuse("the same pair as in row " + std::to_string(first->second));
    }
    pairs.push_back({i, j});
  }
  return pairs;
}

std::optional<NamedNumbers> read(const std::string& file, std::span<const std::size_t> shape) {
  if (file.empty()) return std::nullopt;
  return NamedNumbers{file, read_npy_whole(file, shape).data};
}

}  // namespace

PairChoice pair_choice(const PairArrays& arrays, std::size_t objects) {
  PairChoice choice;
  if (arrays.pairs) choice.only = pairs_from(*arrays.pairs, objects, Repeats::refused);
  if (arrays.without) choice.without = pairs_from(*arrays.without, objects, Repeats::allowed);
  if (arrays.groups) {
    const auto& [name, groups] = *arrays.groups;
    if (groups.size() != objects)
      throw Unusable(name, "has groups of " + std::to_string(groups.size()) +
                               " objects; there are " + std::to_string(objects));
    choice.groups = groups;
  }
  return choice;
}

std::shared_ptr<const std::vector<ObjectPair>> chosen_from(const PairArrays& arrays,
                                                           std::size_t objects) {
  if (arrays.say_nothing()) return nullptr;
  return std::make_shared<const std::vector<ObjectPair>>(
      chosen_pairs(pair_choice(arrays, objects), static_cast<std::uint32_t>(objects)));
}

PairArrays read_pair_arrays(const PairFiles& files) {
  constexpr std::size_t rows[] = {any_length, 2}, one_each[] = {any_length};
  return {read(files.pairs, rows), read(files.without, rows), read(files.groups, one_each)};
}

}  // namespace bvlab
