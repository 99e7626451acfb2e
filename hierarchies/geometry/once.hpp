// SPDX-License-Identifier: BSD-3-Clause
/// Work that is done on first request, once per stamp, even if several threads request it: one
/// thread does it, the others wait. A stamp is a number for the state that the work is done for,
/// such as the epoch of a body. The work must be short and must not request work that could wait
/// for it.
#pragma once

#include <sched.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hierarchies/geometry/unless_done.hpp"

namespace bvlab {

/// Whether several threads may request work at the same time. With one thread a request costs a
/// comparison.
enum class Sharing : std::uint8_t { one_thread, several_threads };

/// Reserved stamps: work in progress, and work that was never done.
inline constexpr std::uint32_t in_work = 0xffffffffu, never_done = 0xfffffffeu;

/// Whether the work has been done under this stamp. The compilers' own atomic operations, since
/// libc++ 16 has no std::atomic_ref.
inline bool is_done(const std::uint32_t& done, std::uint32_t stamp) {
  return __atomic_load_n(&done, __ATOMIC_ACQUIRE) == stamp;
}

namespace detail {
/// Claims the work, or waits until the thread that claimed it is done. Returns whether it was
/// claimed.
[[gnu::noinline]] inline bool take_work(std::uint32_t& done, std::uint32_t stamp) {
  std::uint32_t seen = __atomic_load_n(&done, __ATOMIC_ACQUIRE);
  for (;;) {
    if (seen == stamp) return false;
    if (seen == in_work) {
      sched_yield();
      seen = __atomic_load_n(&done, __ATOMIC_ACQUIRE);
    } else if (__atomic_compare_exchange_n(&done, &seen, in_work, true, __ATOMIC_ACQ_REL,
                                           __ATOMIC_ACQUIRE)) {
      return true;
    }
  }
}
}  // namespace detail

/// Calls work() unless that has been done under this stamp; returns whether it was called. If
/// work() throws, it is not done, and another thread may do it.
template <class Work>
[[gnu::noinline]] bool once(std::uint32_t& done, std::uint32_t stamp, Work work) {
  if (!detail::take_work(done, stamp)) return false;
  UnlessDone undo([&] { __atomic_store_n(&done, never_done, __ATOMIC_RELEASE); });
  work();
  undo.is_done();
  __atomic_store_n(&done, stamp, __ATOMIC_RELEASE);
  return true;
}
/// The same, without atomic operations for one thread.
template <class Work>
bool once(std::uint32_t& done, std::uint32_t stamp, Sharing sharing, Work work) {
  if (sharing == Sharing::several_threads) return !is_done(done, stamp) && once(done, stamp, work);
  if (done == stamp) return false;
  work();
  done = stamp;
  return true;
}

/// The same for each of many pieces of work, which must not throw. Work done by a single thread has
/// stamps of its own, which are read as plain integers: an atomic read, or a check of `Sharing`,
/// makes the loops that use this a tenth slower.
class OnceEach {
 public:
  void make_room(std::size_t count, Sharing sharing) {
    alone_.assign(count, 0);
    set_sharing(sharing);
  }
  /// Sets who may request work from now on.
  void set_sharing(Sharing sharing) {
    if (sharing == Sharing::several_threads && shared_.size() != alone_.size())
      shared_.assign(alone_.size(), 0);
  }
  void forget() {
    std::fill(alone_.begin(), alone_.end(), 0u);
    std::fill(shared_.begin(), shared_.end(), 0u);
  }

  /// Marks everything as done under this stamp, for any thread.
  void all_done(std::uint32_t stamp) { std::fill(alone_.begin(), alone_.end(), stamp); }

  bool done_alone(std::size_t k, std::uint32_t stamp) const { return alone_[k] == stamp; }
  bool done(std::size_t k, std::uint32_t stamp) {
    return done_alone(k, stamp) || (!shared_.empty() && is_done(shared_[k], stamp));
  }
  /// Does work k under this stamp unless another thread has; returns whether it was done here. To
  /// be called where done_alone() is false. Only the work itself is out of line, since several
  /// threads call this for finished work, too.
  template <class Work>
  bool operator()(std::size_t k, std::uint32_t stamp, Sharing sharing, Work work) {
    if (sharing == Sharing::one_thread) return do_alone(k, stamp, work);
    return !is_done(shared_[k], stamp) && once(shared_[k], stamp, work);
  }

 private:
  template <class Work>
  [[gnu::noinline]] bool do_alone(std::size_t k, std::uint32_t stamp, Work work) {
    alone_[k] = stamp;
    work();
    return true;
  }

  std::vector<std::uint32_t> alone_, shared_;  // stamps
};

}  // namespace bvlab
