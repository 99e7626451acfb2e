// SPDX-License-Identifier: BSD-3-Clause
/// The bodies of a scene over one kind of volume. StrategyPairs uses no more than this interface,
/// so that the bvlab program can substitute bodies whose volume is chosen at run time (AnyBodies).
/// What pairs of them run is compiled once for all volumes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "traversal/body.hpp"
#include "traversal/body_pair.hpp"
#include "traversal/gather.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

template <BoundingVolume V>
using Shape = ShapeOver<Hierarchy<V>>;

/// The centre of the box around the origins of all bodies' meshes, as they are posed;
/// bodies.mesh_origin(i) says what they are. Float volumes are posed relative to it, so that
/// their precision does not depend on where in the world the bodies are.
template <class AllBodies>
Vec3<double> centre_of(std::span<const Pose> poses, const AllBodies& bodies) {
  if (poses.empty()) return Vec3<double>::Zero();
  Vec3<double> low = poses[0](bodies.mesh_origin(0)), high = low;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Vec3<double> at = poses[i](bodies.mesh_origin(i));
    low = low.cwiseMin(at), high = high.cwiseMax(at);
  }
  return low / 2 + high / 2;
}

/// B is the scalar or batch in which volumes are tested.
template <class B, BoundingVolume V>
class Bodies {
  static constexpr int W = width<B>();

 public:
  /// Whether testing the roots of many pairs at once pays.
  static constexpr bool culls_in_batches = W > 1;

  /// One body for each shape; meshes and hierarchies must outlive this.
  explicit Bodies(std::span<const Shape<V>> shapes, Frame frame = Frame::world)
      : roots_(shapes.size()), frame_(PlacedRelatively<V> ? frame : Frame::world) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) bodies_.emplace_back(*shape.mesh, *shape.hierarchy, frame);
  }

  /// Adds a body. Bodies may go elsewhere in memory.
  void add(const Shape<V>& shape) {
    bodies_.emplace_back(*shape.mesh, *shape.hierarchy, frame_).set_sharing(sharing_);
    roots_.emplace_back();
  }

  std::size_t size() const { return bodies_.size(); }
  Frame frame() const { return frame_; }
  const TriangleMesh& mesh(std::size_t i) const { return bodies_[i].mesh(); }
  /// See LocalMesh.
  const Vec3<double>& mesh_origin(std::size_t i) const { return bodies_[i].extent().origin; }
  Body<V>& operator[](std::size_t i) { return bodies_[i]; }

  /// Allocates for all bodies, so that nothing is allocated while a run is timed. Otherwise a body
  /// allocates when it is first moved.
  void make_room() {
    for (auto& body : bodies_) body.make_room();
  }

  /// See Body::set_sharing.
  void set_sharing(Sharing sharing) {
    sharing_ = sharing;
    for (auto& body : bodies_) body.set_sharing(sharing);
  }

  /// See Body::move.
  void move(std::size_t i, const Pose& pose, const Vec3<double>& origin) {
    bodies_[i].move(pose, origin);
  }
  /// Moves all bodies; poses[i] is that of body i.
  void move(std::span<const Pose> poses, const Vec3<double>& origin) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].move(poses[i], origin);
  }

  template <class Query, class Counter>
  PairOfBodies<width<B>(), Query, Counter> pair(const ObjectPair& pair, Query& query,
                                                Counter& counter) {
    // Several threads may query pairs at once.
    static thread_local Workspace workspace;
    return BodyPair<B, V, Query, Counter>(bodies_[pair.i], bodies_[pair.j], query, counter,
                                          workspace);
  }

  /// For each p of `fresh`, writes to `apart[p]` whether the query culls the roots of `pairs[p]`,
  /// which is most of the work where bodies are sparse. In the world frame W pairs are tested at
  /// once, in a fraction of the time. Counts the volumes posed, but not the tests.
  template <class Query, class Counter>
  void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                  Query& query, Counter& counter, std::uint8_t* apart) {
    if (frame_ == Frame::body) {
      counter.posed(fresh.size());
      for (const auto p : fresh) apart[p] = roots_are_apart(pairs[p], query);
      return;
    }
    wanted_.assign(bodies_.size(), 0);
    for (const auto p : fresh) wanted_[pairs[p].i] = wanted_[pairs[p].j] = 1;
    bool any_far = false;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!wanted_[i]) continue;
      std::size_t posed = 0;
      bodies_[i].require(0, posed);
      counter.posed(posed);
      roots_[i] = bodies_[i].volumes()[0];
      any_far = any_far || bodies_[i].is_far();
    }
    for (std::size_t first = 0; first < fresh.size(); first += W) {
      std::array<std::uint32_t, W> a, b;
      for (std::size_t k = 0; k < W; ++k) {
        const ObjectPair& pair = pairs[fresh[std::min(first + k, fresh.size() - 1)]];
        a[k] = pair.i, b[k] = pair.j;
      }
      const std::uint64_t culled =
          bits(query.culls(gather<B>(roots_.data(), a.data()), gather<B>(roots_.data(), b.data())));
      for (std::size_t k = 0; k < W && first + k < fresh.size(); ++k)
        apart[fresh[first + k]] = culled >> k & 1;
    }
    if (!any_far) return;
    for (const auto p : fresh)
      if (bodies_[pairs[p].i].is_far() || bodies_[pairs[p].j].is_far())
        counter.posed(1), apart[p] = roots_are_apart(pairs[p], query);
  }

 private:
  template <class Query>
  bool roots_are_apart(const ObjectPair& pair, Query& query) {
    static thread_local Workspace workspace;
    const auto tests = tests_between<1, V, Query>(bodies_[pair.i], bodies_[pair.j], workspace);
    const std::uint32_t root = 0;
    return tests.culled->one(tests, &root, &root, query, nullptr) & 1;
  }

  std::vector<Body<V>> bodies_;
  std::vector<Posed<V>> roots_;       // of all bodies, side by side
  std::vector<std::uint8_t> wanted_;  // for each body, whether its root is tested
  Frame frame_;
  Sharing sharing_ = Sharing::one_thread;
};

}  // namespace bvlab
