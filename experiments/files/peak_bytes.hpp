// SPDX-License-Identifier: BSD-3-Clause
/// The most memory that this process has held at once.
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace bvlab {

/// Resident bytes at their peak; the system counts in KiB.
inline std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace bvlab
