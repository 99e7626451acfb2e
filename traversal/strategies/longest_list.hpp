// SPDX-License-Identifier: BSD-3-Clause
/// The length beyond which a list is rebuilt, whatever its cost.
#pragma once

#include <cstddef>

namespace bvlab {

/// The most entries that the list of a pair of bodies may have: 16 for each node of the two
/// hierarchies. Runs that a hit cuts short cost little, so no rule by cost rebuilds the list, and
/// yet each may lengthen it.
template <class Pair>
std::size_t longest_list(const Pair& pair) {
  return 16 * (pair.a().extent().nodes + pair.b().extent().nodes);
}

}  // namespace bvlab
