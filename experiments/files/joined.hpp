// SPDX-License-Identifier: BSD-3-Clause
/// Lists as messages have them.
#pragma once

#include <functional>
#include <string>

namespace bvlab {

/// The entries of a list, or what `of` makes of each, with commas between.
template <class List, class Of = std::identity>
std::string joined(const List& list, const Of& of = {}, const char* comma = ", ") {
  std::string all;
  for (const auto& each : list) {
    if (!all.empty()) all += comma;
    all += std::invoke(of, each);
  }
  return all;
}

}  // namespace bvlab
