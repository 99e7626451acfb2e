// SPDX-License-Identifier: BSD-3-Clause
/// All that the study of frames compiles for a volume, a fan-out and a frame of comparison.
#pragma once

#include <limits>
#include <vector>

#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/play.hpp"
#include "experiments/studies/frames/frames_entry.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/wide/wide_pairs.hpp"

namespace bvlab {

namespace detail {

template <BoundingVolume V, int F>
std::vector<WideHierarchy<V, F>> wide_hierarchies(std::span<const TriangleMesh> meshes,
                                                  Variant variant) {
  // Leaves are made while the tree is collapsed.
  const std::uint32_t leaf_size = std::exchange(variant.leaf_size, 1);
  std::vector<WideHierarchy<V, F>> hierarchies;
  hierarchies.reserve(meshes.size());
  for (const auto& mesh : meshes)
    hierarchies.emplace_back(mesh, topology_of(mesh, variant), fit_of(variant), leaf_size);
  return hierarchies;
}

template <BoundingVolume V, int F, class Frame>
ReplayResult replay_frame(std::span<const TriangleMesh> meshes, const Trace& trace,
                          const Variant& variant, const ReplayOptions& options) {
  const auto hierarchies = wide_hierarchies<V, F>(meshes, variant);
  std::vector<WideShape<V, F>> shapes;
  for (std::size_t i = 0; i < trace.objects; ++i)
    shapes.push_back({&meshes[i % meshes.size()], &hierarchies[i % meshes.size()]});
  const auto engine = [&](auto) {
    return [&](std::vector<ObjectPair> pairs) {
      return WidePairs<V, F, Frame>(shapes, std::move(pairs));
    };
  };
  ReplayResult result;
  play_over<Touching>(engine, trace, variant, options, result);
  return result;
}

/// C_u and C_v, on data that stay in the second cache: what bench_unit_costs does for binary trees.
template <BoundingVolume V, int F, class Frame>
class FrameCosting {
  using Body = typename Frame::template Body<V, F>;
  using Between = typename Frame::template Between<V, F>;
  using One = typename Between::One;
  static constexpr bool poses_in_between = std::is_same_v<Frame, RelativeFrame>;

 public:
  FrameCosting(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant)
      : hierarchies_(wide_hierarchies<V, F>(meshes, variant)), poses_(trace.objects) {
    for (std::size_t i = 0; i < trace.objects; ++i)
      bodies_.emplace_back(meshes[i % meshes.size()], hierarchies_[i % meshes.size()]);
    trace.poses(0, poses_);
    origin_ = middle_of(poses_);
    for (std::size_t i = 0; i < bodies_.size(); ++i) place(bodies_[i], poses_[i], origin_);
    for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(bodies_.size())))
      if (steps_.size() < enough) walk(i, j);
  }

  FrameCosts costs() { return {begin_ns(), pose_ns(), test_ns()}; }

 private:
  struct Pair {
    std::uint32_t i, j;
    Between between;
    std::vector<std::uint32_t> steps;  // by index
  };
  /// A node of one side against the children of a node of the other.
  struct Step {
    std::size_t pair, side;
    std::uint32_t one, many;
    One posed;
  };
  static constexpr std::size_t enough = 512, of_a_pair = 64;

  /// What a traversal looks at, in any order, until it is enough.
  void walk(std::uint32_t i, std::uint32_t j) {
    pairs_.push_back({i, j, {}, {}});
    Between& between = pairs_.back().between;
    between.begin(bodies_[i], bodies_[j]);
    const auto& a = bodies_[i].hierarchy();
    const auto& b = bodies_[j].hierarchy();
    std::vector<NodePair> open{{0, 0}};
    for (std::size_t done = 0; !open.empty() && done < of_a_pair; ++done) {
      const NodePair pair = open[done % open.size()];
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(done % open.size()));
      const auto &m = a.node(pair.a), &n = b.node(pair.b);
      const bool inner = !m.leaf && !n.leaf;
      const std::size_t side = (m.leaf && !n.leaf) || (inner && n.size > m.size);
      const std::uint32_t one = side ? pair.a : pair.b, many = side ? pair.b : pair.a;
      steps_.push_back({pairs_.size() - 1, side, one, many, between.one(1 - side, one, counter_)});
      const auto seen = between.compared(side, many, steps_.back().posed, counter_);
      const auto& opened = side ? n : m;
      if (opened.leaf) continue;
      for (std::uint64_t left = opened.lanes & ~bits(seen.apart); left; left &= left - 1) {
        const auto child = opened.first + static_cast<std::uint32_t>(std::countr_zero(left));
        open.push_back(side ? NodePair{pair.a, child} : NodePair{child, pair.b});
      }
    }
  }

  double begin_ns() {
    return nanoseconds_each(pairs_.size(), [&] {
      for (auto& pair : pairs_) {
        pair.between.begin(bodies_[pair.i], bodies_[pair.j]);
        keep(pair.between);
      }
    });
  }

  /// All volumes of all bodies.
  double pose_ns() {
    Counting counted;
    const auto all = [&](auto& counter) {
      if constexpr (poses_in_between) {
        for (const auto& pair : pairs_)
          for (std::uint32_t node = 0; node < bodies_[pair.i].hierarchy().size(); ++node)
            keep(pair.between.one(0, node, counter));
      } else {
        // Twice, since what stands where it stood is not posed again.
        for (const double by : {1e-3, 0.0})
          for (std::size_t i = 0; i < bodies_.size(); ++i) {
            Pose pose = poses_[i];
            pose.translation[0] += by;
            bodies_[i].place(pose, origin_);
            for (std::uint32_t node = 0; node < bodies_[i].hierarchy().size(); ++node) {
              keep(bodies_[i].node(node, counter));
              keep(bodies_[i].lanes(node, counter));
            }
          }
      }
    };
    all(counted);
    return nanoseconds_each(counted.n_u, [&] { all(counter_); });
  }

  /// All that is tested is posed.
  double test_ns() {
    std::size_t lanes = 0;
    for (const auto& step : steps_) lanes += lanes_of(step);
    return nanoseconds_each(lanes, [&] {
      for (const auto& step : steps_) {
        const auto& between = pairs_[step.pair].between;
        if constexpr (poses_in_between)
          keep(between.compared(step.side, step.many, step.posed, counter_));
        else
          keep(between.compared(step.side, step.many,
                                between.one(1 - step.side, step.one, counter_), counter_));
      }
    });
  }

  std::size_t lanes_of(const Step& step) const {
    const auto& pair = pairs_[step.pair];
    const auto& hierarchy = bodies_[step.side ? pair.j : pair.i].hierarchy();
    return static_cast<std::size_t>(std::popcount(hierarchy.node(step.many).lanes));
  }

  /// The least of a few rounds, of which each takes about 0.2 ms or more.
  template <class Work>
  static double nanoseconds_each(std::size_t things, const Work& work) {
    double least = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 7; ++round) {
      int times = 0;
      const auto start = Clock::now();
      double seconds = 0;
      for (; seconds < 2e-4; ++times, seconds = seconds_since(start)) work();
      least = std::min(least, seconds / times);
    }
    return things == 0 ? 0 : least * 1e9 / static_cast<double>(things);
  }

  /// The compiler is to think that it is needed.
  template <class X>
  static void keep(const X& x) {
    asm volatile("" : : "r"(&x) : "memory");
  }

  std::vector<WideHierarchy<V, F>> hierarchies_;
  std::vector<Body> bodies_;
  std::vector<Pose> poses_;
  std::vector<Pair> pairs_;
  std::vector<Step> steps_;
  Vec3<double> origin_;
  NotCounting counter_;
};

template <BoundingVolume V, int F, class Frame>
FrameCosts frame_costs(std::span<const TriangleMesh> meshes, const Trace& trace,
                       const Variant& variant) {
  return FrameCosting<V, F, Frame>(meshes, trace, variant).costs();
}

}  // namespace detail

template <BoundingVolume V, int F, class Frame>
constexpr FramesEntry frames_of() {
  return {V::name, Frame::name, F, detail::replay_frame<V, F, Frame>,
          detail::frame_costs<V, F, Frame>};
}

}  // namespace bvlab
