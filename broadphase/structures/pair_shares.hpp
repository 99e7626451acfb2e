// SPDX-License-Identifier: BSD-3-Clause
/// A list of pairs written by several threads, each its own share.
#pragma once

#include <cstddef>
#include <thread>
#include <utility>
#include <vector>

#include "broadphase/structures/pair_list.hpp"

namespace bvlab {

class PairShares {
 public:
  /// Calls work(t, threads, share) on every thread. Shares follow each other, so the list is the
  /// one that a single thread would have written; the first of them is the list itself.
  template <class Work>
  void operator()(std::size_t threads, PairList& list, Work&& work) {
    shares_.resize(threads - 1);
    {
      std::vector<std::jthread> others;
      for (std::size_t t = 1; t < threads; ++t)
        others.emplace_back([&, t] {
          shares_[t - 1].clear();
          work(t, threads, shares_[t - 1]);
        });
      work(std::size_t{0}, threads, list);
    }
    for (const PairList& share : shares_) list.append(share.view());
  }

 private:
  std::vector<PairList> shares_;
};

}  // namespace bvlab
