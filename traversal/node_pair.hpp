// SPDX-License-Identifier: BSD-3-Clause
/// Two nodes, one of each hierarchy.
#pragma once

#include <cstdint>

namespace bvlab {

struct NodePair {
  std::uint32_t a, b;
  friend bool operator==(const NodePair&, const NodePair&) = default;
};

}  // namespace bvlab
