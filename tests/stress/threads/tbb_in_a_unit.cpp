// SPDX-License-Identifier: BSD-3-Clause
/// Compiled without thread sanitizer: see detail::call_on_threads.
#undef BVLAB_TBB_IN_A_UNIT
#include "hierarchies/geometry/threads.hpp"

namespace bvlab::detail {
[[gnu::used]] static const auto defined_here = &call_on_threads;
}  // namespace bvlab::detail
