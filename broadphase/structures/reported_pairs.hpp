// SPDX-License-Identifier: BSD-3-Clause
/// The list of all pairs and, where changes are reported, the pairs that began and ended with this
/// frame. A method that writes its list anew finds the changes by comparing both whole lists.
#pragma once

#include "broadphase/settings.hpp"
#include "broadphase/structures/pair_difference.hpp"
#include "broadphase/structures/pair_list.hpp"

namespace bvlab {

struct ReportedPairs {
  PairList all, began, ended;

  void begin_frame() {
    began.clear();
    ended.clear();
  }

  /// Keeps the list as it stands, to be compared with later.
  void keep_before() {
    before_.clear();
    before_.append(all.view());
  }
  /// Fills `began` and `ended` from the list that was kept and the one there is now.
  void compare_with_kept() { difference_(before_.view(), all.view(), began, ended); }

  /// Takes out pairs that both began and ended: their box changed its place, nothing else did.
  void cancel_out() {
    before_.clear();
    before_.append(ended.view());
    after_.clear();
    after_.append(began.view());
    difference_(before_.view(), after_.view(), began, ended);
  }

  std::size_t bytes() const {
    return sizeof(Pair) * (all.capacity() + began.capacity() + ended.capacity() +
                           before_.capacity() + after_.capacity());
  }

 private:
  PairList before_, after_;
  PairDifference difference_;
};

}  // namespace bvlab
