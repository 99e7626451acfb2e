// SPDX-License-Identifier: BSD-3-Clause
/// Pattern search, a minimisation that needs no derivatives (hooke1961direct): tries steps while
/// they help, and halves the step where none does. Ends after twenty rounds or four halvings.
#pragma once

namespace bvlab {

/// `gained(step)` tries steps of that relative length, and returns whether one was an
/// improvement.
template <class Gained>
void pattern_search(Gained&& gained) {
  constexpr int halvings = 4, most_rounds = 20;
  double step = 0.2;
  for (int round = 0, halved = 0; round < most_rounds && halved < halvings; ++round)
    if (!gained(step)) step /= 2, ++halved;
}

}  // namespace bvlab
