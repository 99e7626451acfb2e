// SPDX-License-Identifier: BSD-3-Clause
/// Not a test of ours: two threads write to one number, and the thread sanitizer must say so. It
/// would be silent if what Threads says of itself (HandedOver) were more than what is so.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "hierarchies/geometry/threads.hpp"

namespace bvlab {
namespace {

TEST(Race, IsFound) {
  Threads threads(2);
  std::size_t sum = 0;
  // Each waits for the other, lest one does all; what is relaxed tells nothing of the number.
  std::atomic<int> begun = 0;
  threads.share(2, [&](std::size_t part, std::size_t) {
    begun.fetch_add(1, std::memory_order_relaxed);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (begun.load(std::memory_order_relaxed) < 2 && std::chrono::steady_clock::now() < end) {
    }
    sum += part;
  });
  EXPECT_GT(sum, 0u);
}

}  // namespace
}  // namespace bvlab
