// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/fcl/convex.hpp"

#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>

#include "experiments/closest_features/polytope.hpp"
#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

constexpr double tolerance = 1e-10;

struct Indep {
  using Solver = fcl::detail::GJKSolver_indep<double>;
  static void set(Solver& solver) {
    solver.gjk_tolerance = tolerance;
    solver.enableCachedGuess(true);
  }
};
struct Libccd {
  using Solver = fcl::detail::GJKSolver_libccd<double>;
  static void set(Solver& solver) { solver.distance_tolerance = tolerance; }
};

template <class Kind>
class FclConvexWorld {
 public:
  FclConvexWorld(std::span<const TriangleMesh> meshes, std::size_t objects) {
    for (const auto& mesh : meshes) {
      const closest_features::Polytope convex(mesh);
      auto faces = std::make_shared<std::vector<int>>();
      for (const auto& face : convex.faces()) {
        faces->push_back(3);
        for (const auto v : face.vertices) faces->push_back(static_cast<int>(v));
      }
      shapes_.push_back(std::make_unique<fcl::Convex<double>>(
          std::make_shared<std::vector<fcl::Vector3d>>(convex.vertices()),
          static_cast<int>(convex.faces().size()), faces));
    }
    poses_.resize(objects, fcl::Transform3d::Identity());
    // What is remembered is of one pair.
    solvers_.resize(objects * objects);
    for (auto& solver : solvers_) Kind::set(solver);
  }

  void place(std::size_t i, const Pose& pose) {
    poses_[i].linear() = pose.rotation;
    poses_[i].translation() = pose.translation;
  }

  double distance(std::size_t i, std::size_t j) {
    auto& solver = solvers_[i * poses_.size() + j];
    double result = 0;
    const bool apart = solver.shapeDistance(shape(i), poses_[i], shape(j), poses_[j], &result);
    return apart ? std::max(0.0, result) : 0;
  }

 private:
  const fcl::Convex<double>& shape(std::size_t i) const { return *shapes_[i % shapes_.size()]; }

  std::vector<std::unique_ptr<fcl::Convex<double>>> shapes_;
  std::vector<fcl::Transform3d> poses_;
  std::vector<typename Kind::Solver> solvers_;
};

}  // namespace

ReplayResult replay_fcl_gjk(std::span<const TriangleMesh> meshes, const Trace& trace,
                            std::string_view query, const ReplayOptions& options) {
  return play_peer<FclConvexWorld<Indep>>(meshes, trace, query, options);
}

ReplayResult replay_libccd_gjk(std::span<const TriangleMesh> meshes, const Trace& trace,
                               std::string_view query, const ReplayOptions& options) {
  return play_peer<FclConvexWorld<Libccd>>(meshes, trace, query, options);
}

}  // namespace bvlab
