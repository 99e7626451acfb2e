// SPDX-License-Identifier: BSD-3-Clause
/// The length at which a list is dropped, whatever its cost.
#pragma once

#include <cstddef>

namespace bvlab {

/// The most entries that the list of a pair of bodies may have: 16 for each node of the two
/// hierarchies. Runs that a hit cuts short cost little, so no rule of cost ends them, and each can
/// let the list grow.
template <class Pair>
std::size_t longest_list(const Pair& pair) {
  return 16 * (pair.a().extent().nodes + pair.b().extent().nodes);
}

}  // namespace bvlab
