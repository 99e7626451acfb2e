// SPDX-License-Identifier: BSD-3-Clause
/// A pool of threads that share a piece of work: TBB's where the library was configured with it
/// (BVLAB_TBB), else the calling thread alone. Between pieces of work they sleep, and take some
/// microseconds to wake.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#if BVLAB_TBB
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#endif

namespace bvlab {

#if BVLAB_TBB
namespace detail {
/// Calls call(with, worker) for each worker below `workers`, on the arena's threads.
///
/// BVLAB_TBB_IN_A_UNIT: defined in a separate unit, compiled without thread sanitizer, which does
/// not see inside TBB's library and reports false races in its headers.
#ifdef BVLAB_TBB_IN_A_UNIT
void call_on_threads(tbb::task_arena& arena, std::size_t workers,
                     void (*call)(void* with, std::size_t worker), void* with);
#else
inline void call_on_threads(tbb::task_arena& arena, std::size_t workers,
                            void (*call)(void* with, std::size_t worker), void* with) {
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, workers, [=](std::size_t worker) { call(with, worker); },
        tbb::static_partitioner());
  });
}
#endif
}  // namespace detail
#endif

class Threads {
 public:
#if BVLAB_TBB
  static constexpr bool available = true;
#else
  static constexpr bool available = false;
#endif

  /// `count` threads, at least 1; always 1 without TBB.
  explicit Threads(int count = 1) : count_(available ? std::max(count, 1) : 1) {
#if BVLAB_TBB
    // Threads beyond the number of processors would wait for each other.
    if (count_ == 1) return;
    arena_ = std::make_unique<tbb::task_arena>(std::min(count_, tbb::info::default_concurrency()));
    left_ = std::vector<Left>(this->count());
#endif
  }

  std::size_t count() const { return static_cast<std::size_t>(count_); }

  /// Calls work(part, worker) for each part below `parts`; a worker, below `count()`, does one part
  /// at a time. Each begins with its own share of the parts, the same for the same `parts`, so that
  /// its cache is still warm; workers that are done help the others. Returns when all are done. An
  /// exception ends the work and is rethrown here.
  template <class Work>
  void share(std::size_t parts, const Work& work) {
    share_ranges(parts, 1, 0, [&](std::size_t begin, std::size_t end, std::size_t worker) {
      for (std::size_t part = begin; part < end; ++part) work(part, worker);
    });
  }

  /// The same with work(begin, end, worker) for ranges that partition 0 .. `count`. A worker takes
  /// half of what is left of its share, but at least `least` at a time, so that all workers end at
  /// about the same time.
  template <class Work>
  void share_out(std::size_t count, std::size_t least, const Work& work) {
    share_ranges(count, least, 2, work);
  }

 private:
  template <class Work>
  void share_ranges(std::size_t count, std::size_t least, [[maybe_unused]] std::size_t divisor,
                    const Work& work) {
    if (count == 0) return;
    if (count_ == 1 || count <= least) return work(std::size_t{0}, count, std::size_t{0});
#if BVLAB_TBB
    const std::size_t workers = this->count();
    for (std::size_t w = 0; w < workers; ++w)
      left_[w].set(count * w / workers, count * (w + 1) / workers);
    const auto all_of = [&](std::size_t worker) {
      for (std::size_t k = 0; k < workers; ++k) {
        Left& left = left_[worker + k < workers ? worker + k : worker + k - workers];
        for (Range r; (r = left.take(least, divisor, k > 0)).begin < r.end;)
          work(std::size_t{r.begin}, std::size_t{r.end}, worker);
      }
    };
    HandedOver handed_over(all_of);
    detail::call_on_threads(*arena_, workers, handed_over.receive, &handed_over);
#endif
  }

#if BVLAB_TBB
  /// Hands work to the workers and back with memory ordering: workers see what was written before,
  /// and later code sees what they wrote. TBB ensures this too, but invisibly to thread sanitizers.
  template <class Work>
  class HandedOver {
   public:
    explicit HandedOver(const Work& work) : work_(work) {
      handed_.store(true, std::memory_order_release);
    }
    /// Also runs where work throws.
    ~HandedOver() { static_cast<void>(returned_.load(std::memory_order_acquire)); }
    HandedOver(const HandedOver&) = delete;
    HandedOver& operator=(const HandedOver&) = delete;

    static void receive(void* handed_over, std::size_t worker) {
      auto& self = *static_cast<HandedOver*>(handed_over);
      static_cast<void>(self.handed_.load(std::memory_order_acquire));
      const Return at_the_end{self.returned_};
      self.work_(worker);
    }

   private:
    struct Return {
      std::atomic<std::size_t>& workers;
      ~Return() { workers.fetch_add(1, std::memory_order_release); }
    };

    const Work& work_;
    std::atomic<bool> handed_ = false;
    std::atomic<std::size_t> returned_ = 0;
  };

  struct Range {
    std::uint32_t begin, end;
  };
  /// The rest of a worker's share, aligned to cache lines of its own. Taking a range does not order
  /// memory with respect to other ranges.
  class alignas(128) Left {
   public:
    void set(std::size_t begin, std::size_t end) {
      range_.store({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)},
                   std::memory_order_relaxed);
    }
    /// Others take from the end, so that the owner's ranges are contiguous.
    Range take(std::size_t least, std::size_t divisor, bool from_end) {
      Range now = range_.load(std::memory_order_relaxed);
      for (;;) {
        const std::uint32_t size = now.end - now.begin;
        const std::size_t share = std::max(least, divisor ? size / divisor : 0);
        const auto taken = static_cast<std::uint32_t>(std::min<std::size_t>(share, size));
        Range rest = now, got = now;
        if (from_end)
          rest.end = got.begin = now.end - taken;
        else
          rest.begin = got.end = now.begin + taken;
        if (taken == 0 || range_.compare_exchange_weak(now, rest, std::memory_order_relaxed))
          return got;
      }
    }

   private:
    std::atomic<Range> range_;
  };
#endif

  int count_;
#if BVLAB_TBB
  std::unique_ptr<tbb::task_arena> arena_;
  std::vector<Left> left_;
#endif
};

}  // namespace bvlab
