// SPDX-License-Identifier: BSD-3-Clause
/// A growing array of pairs that is never initialised before it is written: `std::vector` would
/// clear every page once more than needed. Room is asked for in blocks, so that the loop that
/// finds pairs writes without looking.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>

#include "broadphase/box.hpp"

namespace bvlab {

class PairList {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t capacity() const { return capacity_; }
  Pair* data() { return pairs_.get(); }
  Pair& operator[](std::size_t k) { return pairs_[k]; }
  const Pair& operator[](std::size_t k) const { return pairs_[k]; }
  std::span<const Pair> view() const { return {pairs_.get(), size_}; }

  /// Where the next pairs go: there is room for `more` of them.
  Pair* room_for(std::size_t more) {
    if (size_ + more > capacity_) grow(size_ + more);
    return pairs_.get() + size_;
  }
  /// Everything before `end`, which lies in the last room given, is in the list now.
  void end_at(const Pair* end) { size_ = static_cast<std::size_t>(end - pairs_.get()); }
  void resize_down(std::size_t size) { size_ = size; }

  void push(Pair pair) {
    *room_for(1) = pair;
    ++size_;
  }
  void append(std::span<const Pair> pairs) {
    if (!pairs.empty()) std::memcpy(room_for(pairs.size()), pairs.data(), pairs.size_bytes());
    size_ += pairs.size();
  }

 private:
  void grow(std::size_t least) {
    const std::size_t capacity = std::max(least, capacity_ + capacity_ / 2);
    auto pairs = std::make_unique_for_overwrite<Pair[]>(capacity);
    if (size_) std::memcpy(pairs.get(), pairs_.get(), size_ * sizeof(Pair));
    pairs_ = std::move(pairs);
    capacity_ = capacity;
  }

  std::unique_ptr<Pair[]> pairs_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace bvlab
