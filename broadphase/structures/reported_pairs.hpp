// SPDX-License-Identifier: BSD-3-Clause
/// The list of all pairs and, where changes are reported, the pairs that began and ended in this
/// frame. A method that rewrites its list finds the changes by comparing the two whole lists.
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

  /// Keeps a copy of the list, for `compare_with_kept`.
  void keep_before() {
    before_.clear();
    before_.append(all.view());
  }
  /// Fills `began` and `ended` by comparing the kept list with the present one.
  void compare_with_kept() { difference_(before_.view(), all.view(), began, ended); }

  /// Removes pairs that both began and ended: their box only changed its slot.
  void cancel_out() {
    // Both lists are read before either is written.
    difference_(ended.view(), began.view(), began, ended);
  }

 private:
  PairList before_;
  PairDifference difference_;
};

}  // namespace bvlab
