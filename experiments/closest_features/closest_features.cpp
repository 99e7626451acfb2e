// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/closest_features/closest_features.hpp"

#include <Eigen/Geometry>

#include "experiments/closest_features/gjk.hpp"
#include "experiments/closest_features/v_clip.hpp"
#include "experiments/peers/play_peer.hpp"
#include "traversal/counters.hpp"

namespace bvlab {
namespace {

using closest_features::Effort;
using closest_features::Polytope;

/// What a method remembers of a pair's last question, for each pair.
template <class Method>
class ConvexWorld {
 public:
  ConvexWorld(std::span<const TriangleMesh> meshes, std::size_t objects)
      : poses_(objects), methods_(objects * objects) {
    for (const auto& mesh : meshes) polytopes_.emplace_back(mesh);
  }

  void place(std::size_t i, const Pose& pose) { poses_[i] = pose; }

  bool touching(std::size_t i, std::size_t j) { return distance(i, j) == 0; }

  double distance(std::size_t i, std::size_t j) {
    const closest_features::PosedPair posed(polytopes_[i % polytopes_.size()], poses_[i],
                                            polytopes_[j % polytopes_.size()], poses_[j]);
    Effort effort;
    const auto witness = methods_[i * poses_.size() + j].nearest(posed, effort);
    counter_.tested(effort.vertices), counter_.primitives(effort.steps);
    return witness.distance(posed);
  }

  const Counting& counter() const { return counter_; }

 private:
  std::vector<Polytope> polytopes_;
  std::vector<Pose> poses_;
  std::vector<Method> methods_;
  Counting counter_;
};

template <ClosestFeatures method>
struct MethodOf;
template <>
struct MethodOf<ClosestFeatures::gjk>
    : std::type_identity<closest_features::Gjk<closest_features::Support::scan>> {};
template <>
struct MethodOf<ClosestFeatures::gjk_coherent>
    : std::type_identity<closest_features::Gjk<closest_features::Support::climb>> {};
template <>
struct MethodOf<ClosestFeatures::v_clip> : std::type_identity<closest_features::VClip> {};

}  // namespace

template <ClosestFeatures method>
ReplayResult replay_closest_features(std::span<const TriangleMesh> meshes, const Trace& trace,
                                     std::string_view query, const ReplayOptions& options) {
  return play_peer<ConvexWorld<typename MethodOf<method>::type>>(meshes, trace, query, options);
}

#define BVLAB_CLOSEST(method)                                             \
  template ReplayResult replay_closest_features<ClosestFeatures::method>( \
      std::span<const TriangleMesh>, const Trace&, std::string_view, const ReplayOptions&)
BVLAB_CLOSEST(gjk);
BVLAB_CLOSEST(gjk_coherent);
BVLAB_CLOSEST(v_clip);

}  // namespace bvlab
