// SPDX-License-Identifier: BSD-3-Clause
/// Which pairs of a trace's objects are asked about, as users say it: arrays in files or in memory,
/// checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "traversal/pair_choice.hpp"

namespace bvlab {

/// Whole numbers, with the name that messages give them.
struct NamedNumbers {
  std::string name;
  std::vector<std::int64_t> values;
};
/// What is not there says nothing.
struct PairArrays {
  std::optional<NamedNumbers> pairs{};    ///< (k, 2): the pairs asked for
  std::optional<NamedNumbers> without{};  ///< (k, 2): pairs left out
  std::optional<NamedNumbers> groups{};   ///< (objects,): pairs within a group are left out

  bool say_nothing() const { return !pairs && !without && !groups; }
};

/// Throws Unusable, naming the array and the row: for an object that is not there, a pair of an
/// object with itself, a pair asked for twice, groups of another number of objects.
PairChoice pair_choice(const PairArrays& arrays, std::size_t objects);

/// The chosen pairs as a Trace has them; null where the arrays say nothing.
std::shared_ptr<const std::vector<ObjectPair>> chosen_from(const PairArrays& arrays,
                                                           std::size_t objects);

/// Files, `.npy` of uint32 or int64; an empty name is none.
struct PairFiles {
  std::string pairs, without, groups;

  bool say_nothing() const { return pairs.empty() && without.empty() && groups.empty(); }
};
/// Throws Unusable, naming the file, for what is not such an array.
PairArrays read_pair_arrays(const PairFiles& files);

}  // namespace bvlab
