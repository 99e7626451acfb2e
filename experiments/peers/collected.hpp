// SPDX-License-Identifier: BSD-3-Clause
/// The lists of all folders that were compiled, one after the other.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

namespace bvlab {

template <class Entry>
std::vector<Entry> collected(std::initializer_list<std::span<const Entry> (*)()> lists) {
  std::vector<Entry> all;
  for (const auto list : lists) all.insert(all.end(), list().begin(), list().end());
  return all;
}

}  // namespace bvlab
