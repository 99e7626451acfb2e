// SPDX-License-Identifier: BSD-3-Clause
/// A growable array of pairs whose memory is never initialised: `std::vector` would clear every
/// page before it is written. Room is reserved in blocks, so that the loop that finds pairs writes
/// without checks. Where the finished share of that loop is known, the array grows at once to its
/// likely final size: pages that are never written cost nothing.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <span>
#include <utility>

#include "broadphase/box.hpp"
#include "hierarchies/geometry/pages.hpp"
#include "hierarchies/geometry/unless_done.hpp"

namespace bvlab {

class PairList {
 public:
  PairList() = default;
  PairList(PairList&& other) noexcept
      : pairs_(std::exchange(other.pairs_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        ready_(std::exchange(other.ready_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  PairList& operator=(PairList&& other) noexcept {
    std::swap(pairs_, other.pairs_), std::swap(size_, other.size_);
    std::swap(ready_, other.ready_), std::swap(capacity_, other.capacity_);
    return *this;
  }
  ~PairList() { std::free(pairs_); }

  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t capacity() const { return capacity_; }
  Pair* data() { return pairs_; }
  Pair& operator[](std::size_t k) { return pairs_[k]; }
  const Pair& operator[](std::size_t k) const { return pairs_[k]; }
  std::span<const Pair> view() const { return {pairs_, size_}; }

  /// Reserves room for `more` pairs, and returns where the next one goes.
  Pair* reserve(std::size_t more) {
    if (size_ + more > ready_) [[unlikely]] {
      if (size_ + more > capacity_) grow(std::max(size_ + more, capacity_ + capacity_ / 2));
      make_ready(size_ + more);
    }
    return pairs_ + size_;
  }
  /// The same, where `done` of `all` parts of the work are finished.
  Pair* reserve(std::size_t more, std::size_t done, std::size_t all) {
    if (size_ + more > ready_) [[unlikely]] {
      if (size_ + more > capacity_)
        grow_by_share(size_ + more, static_cast<double>(done) / static_cast<double>(all));
      make_ready(size_ + more);
    }
    return pairs_ + size_;
  }
  /// The same, to be written by several threads: each touches its own pages first.
  Pair* reserve_shared(std::size_t more) {
    if (size_ + more > capacity_) grow(std::max(size_ + more, capacity_ + capacity_ / 2));
    return pairs_ + size_;
  }
  /// Ends the list at `end`, which lies in the room last reserved.
  void set_end(const Pair* end) { size_ = static_cast<std::size_t>(end - pairs_); }
  void resize_down(std::size_t size) { size_ = size; }

  void push(Pair pair) {
    *reserve(1) = pair;
    ++size_;
  }
  void append(std::span<const Pair> pairs) {
    if (!pairs.empty()) std::memcpy(reserve(pairs.size()), pairs.data(), pairs.size_bytes());
    size_ += pairs.size();
  }

 private:
  /// Grows to an eighth more than the finished share predicts, at most sixteenfold, as an early
  /// prediction is vague. The first time large enough that growing later needs no copy.
  void grow_by_share(std::size_t least, double done) {
    least = std::max(least, (std::size_t{1} << 18) / sizeof(Pair));
    const double expected = done > 0 ? 1.125 * static_cast<double>(size_) / done : 0;
    const double most = 16.0 * static_cast<double>(std::max(capacity_, least));
    grow(std::max(
        {least, capacity_ + capacity_ / 2, static_cast<std::size_t>(std::min(expected, most))}));
  }
  void grow(std::size_t capacity) {
    // The system remaps large blocks to other addresses instead of copying them.
    void* const pairs = capacity < static_cast<std::size_t>(-1) / sizeof(Pair)
                            ? std::realloc(pairs_, capacity * sizeof(Pair))
                            : nullptr;
    if (!pairs) fail(std::bad_alloc());
    pairs_ = static_cast<Pair*>(pairs), capacity_ = capacity;
    if (capacity * sizeof(Pair) >= pages::huge && huge_pages_)
      pages::advise(pairs_, pairs_ + capacity_, true);
  }

  /// Populates the next pages: an eighth of the present size, and no more than stays in the cache
  /// until it is written.
  void make_ready(std::size_t least) {
    constexpr std::size_t fewest = (std::size_t{1} << 13) / sizeof(Pair),
                          most = (std::size_t{1} << 18) / sizeof(Pair);
    const std::size_t ready = std::min(least + std::clamp(least / 8, fewest, most), capacity_);
    if (!pages::bring(pairs_ + ready_, pairs_ + ready) && huge_pages_) {
      huge_pages_ = false;
      pages::advise(pairs_, pairs_ + capacity_, false);
    }
    ready_ = ready;
  }

  Pair* pairs_ = nullptr;
  std::size_t size_ = 0;
  std::size_t ready_ = 0;  ///< room that may be written without a check
  std::size_t capacity_ = 0;
  bool huge_pages_ = true;  ///< while the system provides them quickly
};

}  // namespace bvlab
