// SPDX-License-Identifier: BSD-3-Clause
/// Writes one list of pairs with several threads. The work is divided into shares; each thread
/// writes the shares that it takes to a list of its own, and these are concatenated in the order of
/// shares, so that the list is the one that a single thread would write. Shares that the first
/// thread takes from the beginning on are written in place.
///
/// Most pairs are written twice, which limits the gain of two threads on millions of pairs, above
/// all in a first call, where the system provides memory for both copies.
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

  /// Calls work(share, shares, to) for every share and appends what they wrote to the list.
  template <class Work>
  void operator()(PairList& list, std::size_t shares, const Work& work) {
    for (Own& own : own_) own.pairs.clear();
    pieces_.resize(shares);
    std::size_t in_place = 0;  // shares that the first thread took, one after the other
    threads_.share(shares, [&](std::size_t share, std::size_t worker) {
      if (worker == 0 && share == in_place) {
        ++in_place;
        return work(share, shares, list);
      }
      PairList& to = own_[worker].pairs;
      pieces_[share] = {worker, to.size(), 0, 0};
      work(share, shares, to);
      pieces_[share].size = to.size() - pieces_[share].first;
    });
    std::size_t sum = 0;
    for (std::size_t share = in_place; share < shares; ++share)
      pieces_[share].to = sum, sum += pieces_[share].size;
    Pair* const out = list.reserve_shared(sum);
    threads_.share(shares - in_place, [&](std::size_t k, std::size_t) {
      const Piece& piece = pieces_[in_place + k];
      if (piece.size > 0)
        std::memcpy(out + piece.to, own_[piece.worker].pairs.view().data() + piece.first,
                    piece.size * sizeof(Pair));
    });
    list.set_end(out + sum);
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
