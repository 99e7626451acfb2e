// SPDX-License-Identifier: BSD-3-Clause
/// Names of the broad-phase methods, without what they need to run.
#pragma once

#include <string>
#include <vector>

namespace bvlab {

/// In the order of the list.
std::vector<std::string> method_names();

}  // namespace bvlab
