// SPDX-License-Identifier: BSD-3-Clause
/// What strategies keep and hand to `traverse`: the kinds of fronts, and what a traversal says of
/// its work. No volume and no query is named here.
#pragma once

#include <cstddef>

#include "traversal/front.hpp"
#include "traversal/margin_front.hpp"
#include "traversal/relative_motion_bound.hpp"
#include "traversal/rising_front.hpp"

namespace bvlab {

/// What a traversal had to do.
struct TraversalStatistics {
  bool everything = true;     ///< false where the query stopped it
  std::size_t volumes = 0;    ///< pairs of volumes tested
  std::size_t triangles = 0;  ///< pairs of primitives tested
};

/// Whether the two roots are still to be tested, or overlap as somebody else has found.
enum class Start { roots, below_roots };

/// For `traverse` where no front is kept.
struct NoFront {
  static constexpr bool kept = false, rises = false, margins = false;
  static constexpr bool descends_both = false;
};
struct NoFrontBoth : NoFront {
  static constexpr bool descends_both = true;
};
struct KeptFront : NoFront {
  static constexpr bool kept = true;
  Front& front;
};
struct KeptRising : NoFront {
  static constexpr bool kept = true, rises = true;
  RisingFront& front;
};
struct KeptMargins : NoFront {
  static constexpr bool kept = true, margins = true;
  MarginFront& front;
  const RelativeMotionBound& clock;
  double step;  ///< how much nearer the bodies come from run to run, about
};

}  // namespace bvlab
