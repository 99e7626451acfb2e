// SPDX-License-Identifier: BSD-3-Clause
/// Threads that share out a piece of work: TBB's where the library was configured with it
/// (BVLAB_TBB), else the calling one alone. They sleep between pieces of work, and take some
/// microseconds to wake.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>

#if BVLAB_TBB
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#endif

namespace bvlab {

class Threads {
 public:
#if BVLAB_TBB
  static constexpr bool available = true;
#else
  static constexpr bool available = false;
#endif

  /// At least 1; 1 where no more are available.
  explicit Threads(int count = 1) : count_(available ? std::max(count, 1) : 1) {
#if BVLAB_TBB
    // More than there are processors wait for each other.
    if (count_ > 1)
      arena_ =
          std::make_unique<tbb::task_arena>(std::min(count_, tbb::info::default_concurrency()));
#endif
  }

  std::size_t count() const { return static_cast<std::size_t>(count_); }

  /// Calls work(part, worker) for each part below `parts`, by whichever worker below `count()` is
  /// free; a worker does one part at a time, parts in ascending order. Returns when all are done.
  /// What throws ends the work, and is thrown here.
  template <class Work>
  void share(std::size_t parts, const Work& work) {
    if (count_ == 1 || parts <= 1) {
      for (std::size_t part = 0; part < parts; ++part) work(part, std::size_t{0});
      return;
    }
#if BVLAB_TBB
    // What is written before a part is taken, and by those who finish, is seen: by these two, not
    // only by what happens inside of TBB, which thread sanitizers cannot see.
    alignas(64) std::atomic<std::size_t> next;
    alignas(64) std::atomic<std::size_t> finished;
    next.store(0, std::memory_order_release), finished.store(0, std::memory_order_release);
    arena_->execute([&] {
      tbb::parallel_for(
          std::size_t{0}, std::min(count(), parts),
          [&](std::size_t worker) {
            for (std::size_t part; (part = next.fetch_add(1, std::memory_order_acq_rel)) < parts;)
              work(part, worker);
            finished.fetch_add(1, std::memory_order_acq_rel);
          },
          tbb::simple_partitioner());
    });
    finished.load(std::memory_order_acquire);
#endif
  }

 private:
  int count_;
#if BVLAB_TBB
  std::unique_ptr<tbb::task_arena> arena_;
#endif
};

}  // namespace bvlab
