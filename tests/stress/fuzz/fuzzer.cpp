// SPDX-License-Identifier: BSD-3-Clause
/// One target as libFuzzer wants it; BVLAB_FUZZ_TARGET says which.
#include <cstddef>
#include <cstdint>

#include "tests/stress/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bvlab::fuzz::BVLAB_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
