// SPDX-License-Identifier: BSD-3-Clause
/// How well a list could have done: the rebuilds that cost the fewest volume tests, found
/// afterwards for one pair of bodies; and how coherent the motion was, whatever the strategy.
///
/// Model: the cost of a run is its N_v. The state of a list in run f depends on nothing but the run
/// r <= f in which it was rebuilt last, so c(r, f), the tests that it makes in run f, is measured
/// by letting a list live from every r to the end. Then best(f) = min over r of best(r - 1) + c(r,
/// r) +
/// ... + c(r, f), with best(-1) = 0, is the least that any rule for rebuilding can reach: exact, in
/// O(n^2) runs for n frames.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/traverse.hpp"

namespace bvlab {

struct PosePair {
  Pose a, b;
};

struct Coherence {
  double oracle_tests = 0;  ///< N_v with the best rebuilds
  double rebuilds = 0;      ///< how many those are
  double ends = 0;          ///< entries of the recursive fronts, all frames but the last
  double surviving = 0;     ///< of these, entries of the next frame's front too
  double motion = 0;        ///< how much nearer the bodies can come, summed over all steps
};

/// `ask()` makes the query of a run.
template <class B, class V, class Ask>
Coherence coherence_of(Body<V>& a, Body<V>& b, std::span<const PosePair> frames, Ask&& ask) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Vec3<double> origin = Vec3<double>::Zero();
  const std::size_t n = frames.size();
  Workspace workspace;
  NotCounting counter;
  Coherence result;
  // best[f] is best(f - 1), the cost of everything before run f.
  std::vector<double> best(n + 1, infinity), rebuilds(n + 1, 0);
  best[0] = 0;
  for (std::size_t r = 0; r < n; ++r) {
    Front front;
    front.restart();
    double cost = best[r];
    for (std::size_t f = r; f < n; ++f) {
      a.move(frames[f].a, origin), b.move(frames[f].b, origin);
      a.require(0, counter), b.require(0, counter);
      auto query = ask();
      cost += static_cast<double>(traverse<B>(a, b, query, counter, workspace, front).volumes);
      if (cost < best[f + 1]) best[f + 1] = cost, rebuilds[f + 1] = rebuilds[r] + 1;
    }
  }
  result.oracle_tests = best[n], result.rebuilds = rebuilds[n];
  const auto less = [](const NodePair& p, const NodePair& q) {
    return p.a != q.a ? p.a < q.a : p.b < q.b;
  };
  std::vector<NodePair> last, ends, both;
  Stand stand_a, stand_b;
  for (std::size_t f = 0; f < n; ++f) {
    a.move(frames[f].a, origin), b.move(frames[f].b, origin);
    a.require(0, counter), b.require(0, counter);
    std::vector<Contact> found;
    Contacts everything(found);
    Front front;
    front.restart();
    traverse<B>(a, b, everything, counter, workspace, front);
    ends = front.entries();
    std::sort(ends.begin(), ends.end(), less);
    if (f > 0) {
      both.clear();
      std::set_intersection(last.begin(), last.end(), ends.begin(), ends.end(),
                            std::back_inserter(both), less);
      result.ends += static_cast<double>(last.size());
      result.surviving += static_cast<double>(both.size());
      result.motion += step_between(stand_a, a.stand(), a.hierarchy().radius()) +
                       step_between(stand_b, b.stand(), b.hierarchy().radius());
    }
    std::swap(last, ends);
    stand_a = a.stand(), stand_b = b.stand();
  }
  return result;
}

}  // namespace bvlab
