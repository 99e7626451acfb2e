// SPDX-License-Identifier: BSD-3-Clause
/// A search that needs values alone (hooke1961direct): steps this way and that while they help,
/// halved where none does. Ends after twenty rounds or four halvings.
#pragma once

namespace bvlab {

/// `gained(step)` tries steps of that length, relative to whatever is searched, and says whether
/// one was taken.
template <class Gained>
void pattern_search(Gained&& gained) {
  constexpr int halvings = 4, most_rounds = 20;
  double step = 0.2;
  for (int round = 0, halved = 0; round < most_rounds && halved < halvings; ++round)
    if (!gained(step)) step /= 2, ++halved;
}

}  // namespace bvlab
