// SPDX-License-Identifier: BSD-3-Clause
/// What is done when it is first asked for, and once for each stamp, whoever of several threads
/// asks first: the others wait until it is done. What is done must be short and ask for nothing
/// that waits in turn.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <utility>

namespace bvlab {

/// Who asks: one thread alone pays for no more than a comparison.
enum class Askers : std::uint8_t { one, several };

/// No stamp is one of these: of what is being done, and of what never was.
inline constexpr std::uint32_t in_work = 0xffffffffu, never_done = 0xfffffffeu;

/// Whether it has been done under this stamp.
inline bool is_done(std::uint32_t& done, std::uint32_t stamp) {
  return std::atomic_ref(done).load(std::memory_order_acquire) == stamp;
}

namespace detail {
/// Takes the work, or waits for who has taken it: then it is done.
[[gnu::noinline]] inline bool take_work(std::uint32_t& done, std::uint32_t stamp) {
  const std::atomic_ref at(done);
  std::uint32_t seen = at.load(std::memory_order_acquire);
  for (;;) {
    if (seen == stamp) return false;
    if (seen == in_work) {
      std::this_thread::yield();
      seen = at.load(std::memory_order_acquire);
    } else if (at.compare_exchange_weak(seen, in_work, std::memory_order_acq_rel,
                                        std::memory_order_acquire)) {
      return true;
    }
  }
}
}  // namespace detail

/// Calls work() unless that has been done under this stamp; says whether it was called.
template <class Work>
bool once(std::uint32_t& done, std::uint32_t stamp, Work&& work) {
  if (!detail::take_work(done, stamp)) return false;
  std::forward<Work>(work)();
  std::atomic_ref(done).store(stamp, std::memory_order_release);
  return true;
}
/// The same where it is known who asks.
template <class Work>
bool once(std::uint32_t& done, std::uint32_t stamp, Askers askers, Work&& work) {
  if (is_done(done, stamp)) return false;
  if (askers == Askers::several) return once(done, stamp, std::forward<Work>(work));
  std::forward<Work>(work)();
  done = stamp;
  return true;
}

}  // namespace bvlab
