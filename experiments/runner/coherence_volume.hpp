// SPDX-License-Identifier: BSD-3-Clause
/// Coherence for one volume, compiled by itself.
#pragma once

#include <algorithm>
#include <cmath>

#include "experiments/runner/coherence.hpp"
#include "experiments/runner/hierarchies_of.hpp"
#include "experiments/runner/triangle_test.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"

namespace bvlab {

namespace detail {

/// Half the mean of the longest edges.
inline double leaf_size_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle c = mesh.corners(t);
    sum += std::max({(c[0] - c[1]).norm(), (c[1] - c[2]).norm(), (c[2] - c[0]).norm()});
  }
  return sum / 2 / static_cast<double>(std::max<std::size_t>(mesh.triangles.size(), 1));
}

/// A mesh's middle and how far from it the mesh reaches.
struct Middle {
  Vec3<double> centre;
  double radius = 0;

  explicit Middle(const TriangleMesh& mesh) {
    Vec3<double> low = mesh.vertices[0], high = low;
    for (const auto& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    centre = (low + high) / 2;
    for (const auto& v : mesh.vertices) radius = std::max(radius, (v - centre).norm());
  }
};

/// No point of the body has moved farther: |R - R'| = 2 sqrt(2) sin(angle / 2) in Frobenius' norm.
inline double motion(const Middle& middle, const Pose& from, const Pose& to) {
  return (to(middle.centre) - from(middle.centre)).norm() +
         (to.rotation - from.rotation).norm() / std::sqrt(2.0) * middle.radius;
}

template <BoundingVolume V>
class CoherenceMeter {
  using B = NativeBatch<typename V::scalar>;

 public:
  CoherenceMeter(std::span<const TriangleMesh> meshes, std::size_t objects, const Variant& variant)
      : pairs_(all_object_pairs(static_cast<std::uint32_t>(objects))),
        fronts_(pairs_.size()),
        contacts_(variant.query == Contacts::name),
        hierarchies_(hierarchies_of<V>(meshes, variant)) {
    for (const auto& mesh : meshes) {
      middles_.emplace_back(mesh);
      leaf_sizes_.push_back(leaf_size_of(mesh));
    }
    for (std::size_t i = 0; i < objects; ++i)
      bodies_.emplace_back(meshes[i % meshes.size()], hierarchies_[i % meshes.size()]);
  }

  void frame(std::span<const Pose> poses) {
    const bool first = before_.empty();
    for (std::size_t i = 0; i < poses.size(); ++i) bodies_[i].move(poses[i], Vec3<double>::Zero());
    for (std::size_t p = 0; p < pairs_.size(); ++p)
      first ? (void)fresh_front(p, fronts_[p]) : look_at(p, poses);
    before_.assign(poses.begin(), poses.end());
  }

  const CoherenceSums& sums() const { return sums_; }

 private:
  void look_at(std::size_t p, std::span<const Pose> poses) {
    ++sums_.pair_runs;
    const std::size_t ends = fronts_[p].size();
    Front last = fronts_[p];
    const std::uint64_t tests = fresh_front(p, fronts_[p]);
    if (ends == 1 && fronts_[p].size() == 1) return;
    ++sums_.near_runs;
    sums_.tests += tests;
    sums_.ends += ends;
    sums_.kept += shared(last, fronts_[p]);
    Counting again;
    ask(p, last, again);
    sums_.again += again.n_v;
    sums_.grown += last.size() - ends;
    if (last.size() == ends) ++sums_.still_runs, sums_.still_ends += ends;
    measure_motion(pairs_[p], poses);
  }

  void measure_motion(const ObjectPair& pair, std::span<const Pose> poses) {
    const auto of = [&](std::uint32_t i) {
      return motion(middles_[i % middles_.size()], before_[i], poses[i]);
    };
    const double moved = of(pair.i) + of(pair.j);
    if (moved == 0) return;
    ++sums_.moved_runs;
    const double leaf =
        (leaf_sizes_[pair.i % leaf_sizes_.size()] + leaf_sizes_[pair.j % leaf_sizes_.size()]) / 2;
    if (leaf > 0) sums_.motion_leaf += moved / leaf;
    Distance query(0.1);
    NotCounting counter;
    traverse<B>(bodies_[pair.i], bodies_[pair.j], query, counter, workspace_);
    sums_.motion_gap += moved < query.distance() ? moved / query.distance() : 1;
  }

  /// From the roots; gives the tests of volumes it took.
  std::uint64_t fresh_front(std::size_t p, Front& front) {
    front = Front();
    front.restart();
    bodies_[pairs_[p].i].require(0, counter_);
    bodies_[pairs_[p].j].require(0, counter_);
    Counting counter;
    ask(p, front, counter);
    return counter.n_v;
  }

  void ask(std::size_t p, Front& front, Counting& counter) {
    auto &a = bodies_[pairs_[p].i], &b = bodies_[pairs_[p].j];
    if (contacts_) {
      found_.clear();
      Contacts query(found_);
      traverse<B>(a, b, query, counter, workspace_, front);
    } else {
      Touching query;
      traverse<B>(a, b, query, counter, workspace_, front);
    }
  }

  std::size_t shared(const Front& a, const Front& b) {
    const auto before = [](const NodePair& x, const NodePair& y) {
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    };
    old_.assign(a.entries().begin(), a.entries().end());
    new_.assign(b.entries().begin(), b.entries().end());
    std::sort(old_.begin(), old_.end(), before);
    std::sort(new_.begin(), new_.end(), before);
    std::size_t count = 0;
    for (std::size_t i = 0, j = 0; i < old_.size() && j < new_.size();) {
      count += old_[i] == new_[j];
      const bool a_first = before(old_[i], new_[j]), b_first = before(new_[j], old_[i]);
      i += !b_first, j += !a_first;
    }
    return count;
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Front> fronts_;
  bool contacts_;
  std::vector<Hierarchy<V>> hierarchies_;
  std::vector<Middle> middles_;
  std::vector<double> leaf_sizes_;
  std::vector<Body<V>> bodies_;
  std::vector<Pose> before_;
  std::vector<NodePair> old_, new_;
  std::vector<Contact> found_;
  Workspace workspace_;
  NotCounting counter_;
  CoherenceSums sums_;
};

}  // namespace detail

template <BoundingVolume V>
CoherenceSums coherence_of(std::span<const TriangleMesh> meshes, const Trace& trace,
                           const Variant& variant) {
  detail::CoherenceMeter<V> meter(meshes, trace.objects, variant);
  std::vector<Pose> poses(trace.objects);
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    meter.frame(poses);
  }
  return meter.sums();
}

}  // namespace bvlab
