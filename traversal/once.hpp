// SPDX-License-Identifier: BSD-3-Clause
/// What is done when it is first asked for, and once for each stamp, whoever of several threads
/// asks first: the others wait until it is done. What is done must be short and ask for nothing
/// that waits in turn.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

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
[[gnu::noinline]] bool once(std::uint32_t& done, std::uint32_t stamp, Work work) {
  if (!detail::take_work(done, stamp)) return false;
  work();
  std::atomic_ref(done).store(stamp, std::memory_order_release);
  return true;
}
/// The same where it is known who asks.
template <class Work>
bool once(std::uint32_t& done, std::uint32_t stamp, Askers askers, Work work) {
  if (askers == Askers::several) return !is_done(done, stamp) && once(done, stamp, work);
  if (done == stamp) return false;
  work();
  done = stamp;
  return true;
}

/// The same for each of many things. What one thread has done alone has stamps of its own, which it
/// may read as plain numbers: an atomic one, or a look at who asks, makes the loops that ask a
/// tenth slower.
class OnceEach {
 public:
  void make_room(std::size_t count, Askers askers) {
    alone_.assign(count, 0);
    asked_by(askers);
  }
  /// Who asks from now on.
  void asked_by(Askers askers) {
    if (askers == Askers::several && shared_.size() != alone_.size())
      shared_.assign(alone_.size(), 0);
  }
  void forget() {
    std::fill(alone_.begin(), alone_.end(), 0u);
    std::fill(shared_.begin(), shared_.end(), 0u);
  }

  bool done_alone(std::size_t k, std::uint32_t stamp) const { return alone_[k] == stamp; }
  bool done(std::size_t k, std::uint32_t stamp) {
    return done_alone(k, stamp) || (!shared_.empty() && is_done(shared_[k], stamp));
  }
  /// As `once`, of what one thread alone has not done. By itself where there is something to do:
  /// several threads come here for all that has been done.
  template <class Work>
  bool operator()(std::size_t k, std::uint32_t stamp, Askers askers, Work work) {
    if (askers == Askers::one) return do_alone(k, stamp, work);
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
