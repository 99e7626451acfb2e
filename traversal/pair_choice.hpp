// SPDX-License-Identifier: BSD-3-Clause
/// Which pairs of bodies are queried: all, or those of a list; without those of another list, as
/// the neighbouring links of a robot, and without pairs within a group, as welded parts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "traversal/shape.hpp"

namespace bvlab {

/// A pair (j, i) is the pair (i, j).
struct PairChoice {
  std::optional<std::vector<ObjectPair>> only{};  ///< the pairs asked for; nothing: all
  std::vector<ObjectPair> without{};              ///< pairs left out
  /// The group of each body, where there are groups: pairs within one are left out. Bodies of a
  /// negative number, or beyond the end, are in no group.
  std::vector<std::int64_t> groups{};
};

/// Whether a pair is among the chosen. O(log k), k the pairs listed.
class PairFilter {
 public:
  PairFilter() = default;
  explicit PairFilter(const PairChoice& choice)
      : without_(keys_of(choice.without)), groups_(choice.groups) {
    if (choice.only) only_ = keys_of(*choice.only);
  }

  bool operator()(const ObjectPair& pair) const {
    if (pair.i < groups_.size() && pair.j < groups_.size() && groups_[pair.i] >= 0 &&
        groups_[pair.i] == groups_[pair.j])
      return false;
    return (!only_ || has(*only_, pair)) && !has(without_, pair);
  }

 private:
  using Keys = std::vector<std::uint64_t>;

  static std::uint64_t key_of(const ObjectPair& pair) {
    return std::uint64_t{std::min(pair.i, pair.j)} << 32 | std::max(pair.i, pair.j);
  }
  static Keys keys_of(std::span<const ObjectPair> pairs) {
    Keys keys;
    keys.reserve(pairs.size());
    for (const ObjectPair& pair : pairs) keys.push_back(key_of(pair));
    std::sort(keys.begin(), keys.end());
    return keys;
  }
  static bool has(const Keys& keys, const ObjectPair& pair) {
    return !keys.empty() && std::binary_search(keys.begin(), keys.end(), key_of(pair));
  }

  std::optional<Keys> only_;
  Keys without_;
  std::vector<std::int64_t> groups_;
};

/// The chosen pairs, i < j: in the order of the pairs asked for, or (0,1) (0,2) ... (1,2) ...
inline std::vector<ObjectPair> chosen_pairs(const PairChoice& choice, std::uint32_t objects) {
  const PairFilter chosen(choice);
  std::vector<ObjectPair> pairs;
  const auto add = [&](const ObjectPair& pair) {
    if (chosen(pair)) pairs.push_back(pair);
  };
  if (choice.only)
    for (const auto& [i, j] : *choice.only) add({std::min(i, j), std::max(i, j)});
  else
    for (std::uint32_t i = 0; i < objects; ++i)
      for (std::uint32_t j = i + 1; j < objects; ++j) add({i, j});
  return pairs;
}

}  // namespace bvlab
