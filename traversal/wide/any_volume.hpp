// SPDX-License-Identifier: BSD-3-Clause
/// AnyVolume stands for a volume whose type loops do not know: `WidePairs<AnyVolume, F, ...>` is
/// compiled once and traverses the trees of every volume, in either frame (frame.hpp), each through
/// pointers to its tests. A step costs a call more than in loops of the volume's own. A tree is
/// seen as its base, WideTree or TreeInBlocks, whose `calls` are set by `calls_of` (calls_of.hpp)
/// before bodies are made of it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hierarchies/geometry/once.hpp"
#include "hierarchies/wide/tree_in_blocks.hpp"
#include "hierarchies/wide/wide_tree.hpp"
#include "traversal/frame.hpp"
#include "traversal/wide/block_tests.hpp"
#include "traversal/wide/relative_frame.hpp"

namespace bvlab {

struct AnyVolume {
  using scalar = float;
};

/// The volumes of a body in the world's frame: each is posed when it is first tested after a move.
class PosedTree {
 public:
  virtual ~PosedTree() = default;

  /// The body has moved.
  void place(const Pose& pose, const Vec3<double>& origin) {
    if (++epoch_ >= never_done) forget(), epoch_ = 1;
    is_far_ = put_placement(pose, origin);
  }
  /// See MovingBody::is_far.
  bool is_far() const { return is_far_; }
  /// The number of volumes that have been posed since this was called last.
  std::uint64_t take_posed() { return posed_.exchange(0, std::memory_order_relaxed); }

 protected:
  /// Returns whether the body is far.
  virtual bool put_placement(const Pose& pose, const Vec3<double>& origin) = 0;
  /// All epochs have been used: no volume counts as posed.
  virtual void forget() = 0;
  void count_posed(std::uint64_t count) { posed_.fetch_add(count, std::memory_order_relaxed); }

  std::uint32_t epoch_ = 0;

 private:
  bool is_far_ = false;
  std::atomic<std::uint64_t> posed_ = 0;
};

/// A body over the tree of any volume.
template <class Tree>
class AnyBody : public WideBody<Tree> {
 public:
  AnyBody(const TriangleMesh& mesh, const Tree& tree, Frame frame)
      : WideBody<Tree>(mesh, tree),
        posed_(frame == Frame::world ? tree.calls->posed_tree(tree) : nullptr) {}

  bool set_pose(const Pose& pose) {
    const bool moved = WideBody<Tree>::set_pose(pose);
    is_placed_ = is_placed_ && !moved;
    return moved;
  }
  /// To be called before a traversal, by one thread, once the pose is set. `origin` is that of the
  /// world's frame.
  void place(const Vec3<double>& origin) {
    if (!posed_ || (is_placed_ && origin == origin_)) return;
    posed_->place(this->pose(), origin);
    origin_ = origin, is_placed_ = true;
  }
  /// Null in a body's frame.
  PosedTree* posed() const { return posed_.get(); }

 private:
  std::unique_ptr<PosedTree> posed_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool is_placed_ = false;
};

/// The FrameChange of a volume's test, and the test: `Calls` is SiblingCalls or BlockCalls. In the
/// world's frame, its volumes there.
template <class Calls>
struct AnyFrameChange {
  static constexpr std::size_t room = 1024;
  const Calls* calls;
  std::array<PosedTree*, 2> in_world{};  ///< of the volumes that are tested; of those in the lanes
  alignas(64) std::array<std::byte, room> change;

  AnyFrameChange() = default;
  /// `body` is of the volumes that are posed.
  template <class Tree>
  AnyFrameChange(const RelativePose& pose, const AnyBody<Tree>& body, const AnyBody<Tree>& other)
      : calls(body.hierarchy().calls) {
    if (body.posed() && !body.posed()->is_far() && !other.posed()->is_far())
      calls = calls->in_world, in_world = {body.posed(), other.posed()};
    else
      calls->put_change(change.data(), pose, body.hierarchy().reach(), other.hierarchy().reach());
  }
  /// Volumes in the world are counted where they are posed.
  template <class Counter>
  void count_posed(Counter& counter, std::uint64_t count) const {
    if (!in_world[0]) counter.posed(count);
  }
};

/// Loops find here that there is no test but those of the trees.
template <class Calls>
struct CalledTest {
  using FrameChange = AnyFrameChange<Calls>;
};

/// A node's volume, or with a lane that of its child there.
template <int F>
struct VolumeInTree {
  static constexpr int none = -1;
  const WideTree<float, F>* tree;
  std::uint32_t node;
  int lane = none;
};

/// The tests of a volume against the children of a node; the change is into their frame.
template <int F>
struct SiblingCalls {
  using Tree = WideTree<float, F>;
  using S = typename Tree::Lane;
  using Change = AnyFrameChange<SiblingCalls>;
  struct Step {
    VolumeInTree<F> one;
    const Tree& tree;
    std::uint32_t parent;
    const Change& change;
  };

  const SiblingCalls* in_world;
  std::unique_ptr<PosedTree> (*posed_tree)(const Tree&);
  void (*put_change)(void* to, const RelativePose&, double reach, double reach_of_lanes);
  OverlapLanes<S> (*overlap)(const Step&);
  GapLanes<S> (*separation)(const Step&);
  S (*gaps)(const Step&);
};

/// The tests of BlockTests.
struct BlockCalls {
  using S = SixteenLanes;
  using Change = AnyFrameChange<BlockCalls>;
  struct Four {
    const TreeInBlocks::Row &row_a, &row_b;
    const Change& change;
  };
  struct One {
    const TreeInBlocks::Node& one;
    const TreeInBlocks::Block& block;
    const Change& change;
  };
  /// Of a register of the sixteen lanes.
  template <class Step>
  struct Of {
    OverlapLanes<S> (*overlap)(const Step&, std::size_t part);
    GapLanes<S> (*separation)(const Step&, std::size_t part);
    S (*gaps)(const Step&, std::size_t part);
  };

  const BlockCalls* in_world;
  std::unique_ptr<PosedTree> (*posed_tree)(const TreeInBlocks&);
  void (*put_change)(void* to, const RelativePose&, double reach, double reach_of_lanes);
  Of<Four> four;
  Of<One> one;
};

namespace detail {
template <>
struct SiblingTestOf<AnyVolume> {
  using type = CalledTest<BlockCalls>;
};
template <class Tree>
struct BodyOf<AnyVolume, Tree> {
  using type = AnyBody<Tree>;
};
}  // namespace detail

template <int F>
class RelativeFrame<AnyVolume, F>
    : public FramesOfTrees<AnyBody<WideTree<float, F>>, CalledTest<SiblingCalls<F>>> {
  using Frames = FramesOfTrees<AnyBody<WideTree<float, F>>, CalledTest<SiblingCalls<F>>>;
  using Frames::trees_, Frames::frames_;
  using Calls = SiblingCalls<F>;
  using S = Batch<float, F>;

 public:
  using PosedNode = VolumeInTree<F>;

  template <class Counter>
  [[gnu::always_inline]] PosedNode posed_node(std::size_t side, std::uint32_t node,
                                              Counter& counter) const {
    frames_.count_posed(counter, 1 - side, 1);
    return {trees_[side], node};
  }
  template <class Counter>
  PosedNode posed_child(std::size_t side, std::uint32_t node, int lane, Counter& counter) const {
    frames_.count_posed(counter, 1 - side, 1);
    return {trees_[side], node, lane};
  }
  OverlapLanes<S> overlap(std::size_t side, std::uint32_t node, const PosedNode& posed) const {
    return frames_.change[side].calls->overlap(step(side, node, posed));
  }
  S gaps(std::size_t side, std::uint32_t node, const PosedNode& posed) const {
    return frames_.change[side].calls->gaps(step(side, node, posed));
  }
  GapLanes<S> separation(std::size_t side, std::uint32_t node, const PosedNode& posed) const {
    return frames_.change[side].calls->separation(step(side, node, posed));
  }
  const void* lanes(std::size_t side, std::uint32_t node) const {
    return &trees_[side]->node(node);
  }

 private:
  [[gnu::always_inline]] typename Calls::Step step(std::size_t side, std::uint32_t node,
                                                   const PosedNode& posed) const {
    return {posed, *trees_[side], node, frames_.change[side]};
  }
};

template <>
struct BlockTests<AnyVolume> {
  using S = SixteenLanes;
  using Tree = TreeInBlocks;
  using SiblingTest = CalledTest<BlockCalls>;

  template <class Step, BlockCalls::Of<Step> BlockCalls::*tests>
  struct Called : Step {
    OverlapLanes<S> overlap(std::size_t part) const {
      return (this->change.calls->*tests).overlap(*this, part);
    }
    GapLanes<S> separation(std::size_t part) const {
      return (this->change.calls->*tests).separation(*this, part);
    }
    S gaps(std::size_t part) const { return (this->change.calls->*tests).gaps(*this, part); }
  };
  using Four = Called<BlockCalls::Four, &BlockCalls::four>;
  using One = Called<BlockCalls::One, &BlockCalls::one>;
};

}  // namespace bvlab
