// SPDX-License-Identifier: BSD-3-Clause
/// AnyVolume stands for a volume whose type loops do not know: `WidePairs<AnyVolume, F, ...>` is
/// compiled once and traverses the trees of every volume, each through pointers to its tests. A
/// step costs a call more than in loops of the volume's own. A tree is seen as its base, WideTree
/// or BlockTree, whose `calls` are set by `calls_of` before bodies are made of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>

#include "hierarchies/wide/block_hierarchy.hpp"
#include "hierarchies/wide/wide_hierarchy.hpp"
#include "traversal/wide/block_tests.hpp"
#include "traversal/wide/relative_frame.hpp"

namespace bvlab {

struct AnyVolume {
  using scalar = float;
};

/// The FrameChange of a volume's test, and the test: `Calls` is SiblingCalls or BlockCalls.
template <class Calls>
struct AnyFrameChange {
  static constexpr std::size_t room = 1024;
  const Calls* calls;
  alignas(64) std::array<std::byte, room> change;

  AnyFrameChange() = default;
  /// `tree` is of the volumes that are posed.
  template <class Tree>
  AnyFrameChange(const RelativePose& pose, const Tree& tree, const Tree& other)
      : calls(tree.calls) {
    calls->put_change(change.data(), pose, tree.reach(), other.reach());
  }
};

/// Loops find here that there is no test but those of the trees.
template <class Calls>
struct CalledTest {
  using FrameChange = AnyFrameChange<Calls>;
};

/// A node's volume, or with a lane that of its child there, to be posed by the test.
template <int F>
struct VolumeInTree {
  const WideTree<float, F>* tree;
  std::uint32_t node;
  int lane = none;

  static constexpr int none = -1;
};

/// The tests of a volume against the children of a node. `change` is into their frame.
template <int F>
struct SiblingCalls {
  using Tree = WideTree<float, F>;
  using S = typename Tree::Lane;

  void (*put_change)(void* to, const RelativePose&, double reach, double reach_of_lanes);
  OverlapLanes<S> (*overlap)(const VolumeInTree<F>&, const void* change, const Tree&,
                             std::uint32_t parent);
  GapLanes<S> (*separation)(const VolumeInTree<F>&, const void* change, const Tree&,
                            std::uint32_t parent);
  S (*gaps)(const VolumeInTree<F>&, const void* change, const Tree&, std::uint32_t parent);
};

/// The tests of BlockTests.
struct BlockCalls {
  using S = SixteenLanes;
  struct Four {
    const BlockTree::Row &a, &b;
    const void* into_b;
    std::size_t part;
  };
  struct One {
    const BlockTree::Node& one;
    const BlockTree::Block& block;
    const void* change;
    std::size_t part;
  };

  void (*put_change)(void* to, const RelativePose&, double reach, double reach_of_lanes);
  OverlapLanes<S> (*overlap_of_four)(const Four&);
  GapLanes<S> (*separation_of_four)(const Four&);
  S (*gaps_of_four)(const Four&);
  OverlapLanes<S> (*overlap_of_one)(const One&);
  GapLanes<S> (*separation_of_one)(const One&);
  S (*gaps_of_one)(const One&);
};

namespace detail {

template <class V>
void put_change(void* to, const RelativePose& pose, double reach, double reach_of_lanes) {
  using Change = typename bvlab::SiblingTestOf<V>::FrameChange;
  using Any = AnyFrameChange<BlockCalls>;
  static_assert(sizeof(Change) <= Any::room && alignof(Change) <= alignof(Any));
  ::new (to) Change(bvlab::SiblingTestOf<V>::frame_change(pose, reach, reach_of_lanes));
}
template <class V>
const auto& change_of(const void* change) {
  return *static_cast<const typename bvlab::SiblingTestOf<V>::FrameChange*>(change);
}

template <class V, int F>
struct CalledSiblings {
  using Test = bvlab::SiblingTestOf<V>;
  using Hierarchy = WideHierarchy<V, F>;
  using Tree = WideTree<float, F>;
  using S = typename Tree::Lane;

  /// Calls `test` with the posed volume, the change of frames, the siblings, and the sums of sizes.
  template <class Do>
  [[gnu::always_inline]] static auto with(const VolumeInTree<F>& one, const void* into,
                                          const Tree& tree, std::uint32_t parent, const Do& test) {
    const auto& change = change_of<V>(into);
    const auto& from = static_cast<const Hierarchy&>(*one.tree);
    const auto& lanes = static_cast<const Hierarchy&>(tree).children(parent);
    const auto posed = [&] {
      if (one.lane == VolumeInTree<F>::none)
        return Test::posed_node(from.node(one.node).volume, from.node(one.node).size, change);
      const auto& siblings = from.children(one.node);
      return Test::posed_node(lane_of<V>(siblings.volumes, one.lane),
                              float(siblings.size[static_cast<std::size_t>(one.lane)]), change);
    }();
    return test(posed, change, lanes.volumes, lanes.size + S(posed.size));
  }
  static OverlapLanes<S> overlap(const VolumeInTree<F>& one, const void* into, const Tree& tree,
                                 std::uint32_t parent) {
    return with(one, into, tree, parent, [](const auto&... x) {
      return Test::template overlap<S>(x...);
    });
  }
  static GapLanes<S> separation(const VolumeInTree<F>& one, const void* into, const Tree& tree,
                                std::uint32_t parent) {
    return with(one, into, tree, parent,
                [](const auto&... x) { return separation_of<Test, S>(x...); });
  }
  static S gaps(const VolumeInTree<F>& one, const void* into, const Tree& tree,
                std::uint32_t parent) {
    return with(one, into, tree, parent,
                [](const auto& posed, const auto& change, const auto& lanes, const S&) {
                  return Test::template gaps<S>(posed, change, lanes);
                });
  }
};

template <class V>
struct CalledBlocks {
  using S = SixteenLanes;
  using Tests = BlockTests<V>;
  using Tree = BlockHierarchy<V>;

  static typename Tests::Four typed(const BlockCalls::Four& four) {
    return {static_cast<const typename Tree::Row&>(four.a),
            static_cast<const typename Tree::Row&>(four.b), change_of<V>(four.into_b)};
  }
  static typename Tests::One typed(const BlockCalls::One& one) {
    return {static_cast<const typename Tree::Node&>(one.one),
            static_cast<const typename Tree::Block&>(one.block), change_of<V>(one.change)};
  }
  template <class Call>
  static OverlapLanes<S> overlap(const Call& call) {
    return typed(call).overlap(call.part);
  }
  template <class Call>
  static GapLanes<S> separation(const Call& call) {
    return typed(call).separation(call.part);
  }
  template <class Call>
  static S gaps(const Call& call) {
    return typed(call).gaps(call.part);
  }
};

template <class V, int F>
inline constexpr SiblingCalls<F> sibling_calls{put_change<V>, CalledSiblings<V, F>::overlap,
                                               CalledSiblings<V, F>::separation,
                                               CalledSiblings<V, F>::gaps};
template <class V>
inline constexpr BlockCalls block_calls{
    put_change<V>,
    CalledBlocks<V>::template overlap<BlockCalls::Four>,
    CalledBlocks<V>::template separation<BlockCalls::Four>,
    CalledBlocks<V>::template gaps<BlockCalls::Four>,
    CalledBlocks<V>::template overlap<BlockCalls::One>,
    CalledBlocks<V>::template separation<BlockCalls::One>,
    CalledBlocks<V>::template gaps<BlockCalls::One>};

}  // namespace detail

/// The tests of a tree's volumes.
template <BoundingVolume V, int F>
const SiblingCalls<F>* calls_of(const WideHierarchy<V, F>&) {
  return &detail::sibling_calls<V, F>;
}
template <BoundingVolume V>
const BlockCalls* calls_of(const BlockHierarchy<V>&) {
  return &detail::block_calls<V>;
}

namespace detail {
template <>
struct SiblingTestOf<AnyVolume> {
  using type = CalledTest<BlockCalls>;
};
}  // namespace detail

template <int F>
class RelativeFrame<AnyVolume, F> : public FramesOfTrees<WideTree<float, F>, CalledTest<SiblingCalls<F>>> {
  using Frames = FramesOfTrees<WideTree<float, F>, CalledTest<SiblingCalls<F>>>;
  using Frames::trees_, Frames::frames_;
  using S = Batch<float, F>;

 public:
  using PosedNode = VolumeInTree<F>;

  template <class Counter>
  [[gnu::always_inline]] PosedNode posed_node(std::size_t side, std::uint32_t node,
                                              Counter& counter) const {
    counter.posed(1);
    return {trees_[side], node};
  }
  template <class Counter>
  PosedNode posed_child(std::size_t side, std::uint32_t node, int lane, Counter& counter) const {
    counter.posed(1);
    return {trees_[side], node, lane};
  }
  OverlapLanes<S> overlap(std::size_t side, std::uint32_t node, const PosedNode& posed) const {
    return call(&SiblingCalls<F>::overlap, side, node, posed);
  }
  S gaps(std::size_t side, std::uint32_t node, const PosedNode& posed) const {
    return call(&SiblingCalls<F>::gaps, side, node, posed);
  }
  GapLanes<S> separation(std::size_t side, std::uint32_t node, const PosedNode& posed) const {
    return call(&SiblingCalls<F>::separation, side, node, posed);
  }
  const void* lanes(std::size_t side, std::uint32_t node) const {
    return &trees_[side]->node(node);
  }

 private:
  template <class Call>
  [[gnu::always_inline]] auto call(Call which, std::size_t side, std::uint32_t node,
                                   const PosedNode& posed) const {
    const auto& into = frames_.change[side];
    return (into.calls->*which)(posed, into.change.data(), *trees_[side], node);
  }
};

template <>
struct BlockTests<AnyVolume> {
  using S = SixteenLanes;
  using Tree = BlockTree;
  using SiblingTest = CalledTest<BlockCalls>;
  using FrameChange = SiblingTest::FrameChange;

  class Four {
   public:
    const Tree::Row &row_a, &row_b;

    Four(const Tree::Row& a, const Tree::Row& b, const FrameChange& into_b)
        : row_a(a), row_b(b), into_b_(into_b) {}
    OverlapLanes<S> overlap(std::size_t part) const {
      return into_b_.calls->overlap_of_four(call(part));
    }
    GapLanes<S> separation(std::size_t part) const {
      return into_b_.calls->separation_of_four(call(part));
    }
    S gaps(std::size_t part) const { return into_b_.calls->gaps_of_four(call(part)); }

   private:
    BlockCalls::Four call(std::size_t part) const { return {row_a, row_b, into_b_.change.data(), part}; }

    const FrameChange& into_b_;
  };
  class One {
   public:
    const Tree::Block& block;

    One(const Tree::Node& one, const Tree::Block& lanes, const FrameChange& change)
        : block(lanes), one_(one), change_(change) {}
    OverlapLanes<S> overlap(std::size_t part) const {
      return change_.calls->overlap_of_one(call(part));
    }
    GapLanes<S> separation(std::size_t part) const {
      return change_.calls->separation_of_one(call(part));
    }
    S gaps(std::size_t part) const { return change_.calls->gaps_of_one(call(part)); }

   private:
    BlockCalls::One call(std::size_t part) const {
      return {one_, block, change_.change.data(), part};
    }

    const Tree::Node& one_;
    const FrameChange& change_;
  };
};

}  // namespace bvlab
