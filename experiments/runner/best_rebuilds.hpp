// SPDX-License-Identifier: BSD-3-Clause
/// How well a separation list could have done: the rebuilds that cost the fewest tests of volumes,
/// found afterwards. What any rule for rebuilding is to be compared with.
///
/// The state of a list in run f depends on nothing but the run r <= f in which it was rebuilt last;
/// so c(r, f), the tests it makes in run f, is measured by letting a list live from every r to the
/// end. Then
///
///   best(f) = min over r <= f of best(r - 1) + c(r, r) + ... + c(r, f),   best(-1) = 0,
///
/// is the least that can be reached: exact, by O(frames^2) runs for every pair.
#pragma once

#include <limits>

#include "experiments/runner/coherence.hpp"
#include "experiments/runner/hierarchies_of.hpp"
#include "experiments/runner/triangle_test.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"

namespace bvlab {

namespace detail {

template <BoundingVolume V>
class RebuildSearch {
  using B = NativeBatch<typename V::scalar>;

 public:
  RebuildSearch(Body<V>& a, Body<V>& b, bool contacts) : a_(a), b_(b), contacts_(contacts) {}

  /// `poses(f)` gives both bodies' poses in frame f of n.
  template <class Poses>
  BestRebuilds search(std::size_t n, Poses&& poses) {
    constexpr auto never = std::numeric_limits<std::uint64_t>::max();
    // before[f] is of all runs before f.
    std::vector<BestRebuilds> before(n + 1, BestRebuilds{never, 0});
    before[0] = {};
    for (std::size_t r = 0; r < n; ++r) {
      Front front;
      front.restart();
      std::uint64_t tests = before[r].tests;
      for (std::size_t f = r; f < n; ++f) {
        const auto& [pose_a, pose_b] = poses(f);
        a_.move(pose_a, Vec3<double>::Zero()), b_.move(pose_b, Vec3<double>::Zero());
        tests += run(front);
        if (tests < before[f + 1].tests) before[f + 1] = {tests, before[r].rebuilds + 1};
      }
    }
    return before[n];
  }

 private:
  std::uint64_t run(Front& front) {
    NotCounting counter;
    a_.require(0, counter), b_.require(0, counter);
    found_.clear();
    if (contacts_) {
      Contacts query(found_);
      return traverse<B>(a_, b_, query, counter, workspace_, front).volumes;
    }
    Touching query;
    return traverse<B>(a_, b_, query, counter, workspace_, front).volumes;
  }

  Body<V>&a_, &b_;
  bool contacts_;
  std::vector<Contact> found_;
  Workspace workspace_;
};

}  // namespace detail

template <BoundingVolume V>
BestRebuilds best_rebuilds_of(std::span<const TriangleMesh> meshes, const Trace& trace,
                              const Variant& variant) {
  const auto hierarchies = hierarchies_of<V>(meshes, variant);
  std::vector<std::vector<Pose>> poses(trace.frames, std::vector<Pose>(trace.objects));
  for (std::size_t frame = 0; frame < trace.frames; ++frame) trace.poses(frame, poses[frame]);
  BestRebuilds sum;
  for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(trace.objects))) {
    const std::size_t m = i % meshes.size(), n = j % meshes.size();
    Body<V> a(meshes[m], hierarchies[m]), b(meshes[n], hierarchies[n]);
    detail::RebuildSearch<V> search(a, b, variant.query == Contacts::name);
    const BestRebuilds best = search.search(trace.frames, [&](std::size_t f) {
      return std::pair<const Pose&, const Pose&>(poses[f][i], poses[f][j]);
    });
    sum.tests += best.tests, sum.rebuilds += best.rebuilds;
  }
  return sum;
}

}  // namespace bvlab
