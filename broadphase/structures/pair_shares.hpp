// SPDX-License-Identifier: BSD-3-Clause
/// A list of pairs written by several threads. The work is divided into shares; each thread writes
/// what it takes of them to a list of its own, and these are put together in the order of the
/// shares, so that the list is the one that a single thread would have written.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "broadphase/structures/pair_list.hpp"
#include "hierarchies/geometry/threads.hpp"

namespace bvlab {

class PairShares {
 public:
  explicit PairShares(int threads) : threads_(threads), own_(threads_.count()) {}

  Threads& threads() { return threads_; }

  /// Calls work(share, shares, to) for every share, and adds to the list what they wrote.
  template <class Work>
  void operator()(PairList& list, std::size_t shares, const Work& work) {
    for (Own& own : own_) own.pairs.clear();
    pieces_.resize(shares);
    threads_.share(shares, [&](std::size_t share, std::size_t worker) {
      PairList& to = own_[worker].pairs;
      pieces_[share] = {worker, to.size(), 0, 0};
      work(share, shares, to);
      pieces_[share].size = to.size() - pieces_[share].first;
    });
    std::size_t sum = 0;
    for (Piece& piece : pieces_) piece.to = sum, sum += piece.size;
    Pair* const out = list.room_for(sum);
    threads_.share(shares, [&](std::size_t share, std::size_t) {
      const Piece& piece = pieces_[share];
      if (piece.size > 0)
        std::memcpy(out + piece.to, own_[piece.worker].pairs.view().data() + piece.first,
                    piece.size * sizeof(Pair));
    });
    list.end_at(out + sum);
  }

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Own& own : own_) sum += own.pairs.capacity() * sizeof(Pair);
    return sum;
  }

 private:
  struct alignas(128) Own {  // in cache lines of its own
    PairList pairs;
  };
  struct Piece {
    std::size_t worker, first, size, to;
  };

  Threads threads_;
  std::vector<Own> own_;
  std::vector<Piece> pieces_;
};

}  // namespace bvlab
