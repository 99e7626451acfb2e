// SPDX-License-Identifier: BSD-3-Clause
/// The tests of a volume as loops call them that do not know it (any_volume.hpp): in a body's frame
/// those of its sibling test, and in the world's frame those of its posed form.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "hierarchies/geometry/large_vector.hpp"
#include "hierarchies/geometry/once.hpp"
#include "hierarchies/relative_placement.hpp"
#include "hierarchies/wide/block_hierarchy.hpp"
#include "hierarchies/wide/wide_hierarchy.hpp"
#include "traversal/wide/any_volume.hpp"

namespace bvlab {

namespace called {

template <class V>
void put_change(void* to, const RelativePose& pose, double reach, double reach_of_lanes) {
  using Change = typename bvlab::SiblingTestOf<V>::FrameChange;
  using Any = AnyFrameChange<BlockCalls>;
  static_assert(sizeof(Change) <= Any::room && alignof(Change) <= alignof(Any));
  ::new (to) Change(bvlab::SiblingTestOf<V>::frame_change(pose, reach, reach_of_lanes));
}
template <class V, class Change>
const auto& change_of(const Change& any) {
  return *reinterpret_cast<const typename bvlab::SiblingTestOf<V>::FrameChange*>(any.change.data());
}

/// Things that are made when they are first asked for in an epoch, by any thread.
template <class T>
class MadeOnce {
 public:
  explicit MadeOnce(std::size_t count) : all_(count), done_(count, 0) {}

  template <class Make>
  const T& operator()(std::size_t i, std::uint32_t epoch, const Make& make) {
    if (!is_done(done_[i], epoch)) once(done_[i], epoch, [&] { make(all_[i]); });
    return all_[i];
  }
  void forget() { std::fill(done_.begin(), done_.end(), 0u); }

 private:
  LargeVector<T> all_;
  std::vector<std::uint32_t> done_;
};

/// The placement of a tree's volumes in the world.
template <class V, class Tree>
class PosedTreeOf : public PosedTree {
 public:
  explicit PosedTreeOf(const Tree& tree)
      : tree_(tree),
        extent_{tree.sphere().centre, tree.sphere().radius, tree.reach(),
                tree.size(),          leaves_of(tree),      tree.origin()},
        node_(tree.size()) {}

  /// A node's volume.
  const Posed<V>& node(std::uint32_t i) {
    return node_(i, epoch_, [&](Posed<V>& to) {
      ::new (&to) Posed<V>(posed(tree_.node(i).volume, placement_));
      count_posed(1);
    });
  }

 protected:
  bool put_placement(const Pose& pose, const Vec3<double>& origin) override {
    placement_ = world_placement<V>(pose, origin, extent_);
    return !((pose(extent_.origin) - origin).template lpNorm<1>() <=
             far_from_origin<typename V::scalar>(extent_));
  }

  void forget() override { node_.forget(); }

  const Tree& tree_;
  PlacementOf<V> placement_;

 private:
  static std::size_t leaves_of(const Tree& tree) {
    std::size_t leaves = 0;
    for (std::uint32_t i = 0; i < tree.size(); ++i) leaves += tree.node(i).leaf != 0;
    return leaves;
  }

  HierarchyExtent extent_;
  MadeOnce<Posed<V>> node_;
};

/// The same with the children of nodes, in lanes.
template <class V, int F>
class PosedSiblings final : public PosedTreeOf<V, WideHierarchy<V, F>> {
  using Base = PosedTreeOf<V, WideHierarchy<V, F>>;

 public:
  using Lanes = Over<Posed<V>, Batch<float, F>>;

  explicit PosedSiblings(const WideHierarchy<V, F>& tree) : Base(tree), children_(tree.size()) {}

  const Lanes& children(std::uint32_t i) {
    return children_(i, this->epoch_, [&](Lanes& to) {
      ::new (&to) Lanes(posed(this->tree_.children(i).volumes, this->placement_));
      this->count_posed(static_cast<std::uint64_t>(std::popcount(this->tree_.node(i).lanes)));
    });
  }

 private:
  void forget() override { Base::forget(), children_.forget(); }

  MadeOnce<Lanes> children_;
};

/// The same with rows and blocks. What lanes repeat is counted as often as it is posed.
template <class V>
class PosedBlocks final : public PosedTreeOf<V, BlockHierarchy<V>> {
  using Base = PosedTreeOf<V, BlockHierarchy<V>>;
  using Tree = BlockHierarchy<V>;

 public:
  /// As BlockHierarchy::Lanes.
  template <std::size_t width>
  struct alignas(64) Lanes {
    std::array<float, width> size;
    std::array<std::array<float, width>, sizeof(Posed<V>) / sizeof(float)> volume;
  };

  explicit PosedBlocks(const Tree& tree) : Base(tree), rows_(tree.rows()), blocks_(tree.rows()) {}

  const Lanes<4>& row(const typename Tree::Row& stored) {
    return lanes(rows_, stored, this->tree_.row(0));
  }
  const Lanes<16>& block(const typename Tree::Block& stored) {
    return lanes(blocks_, stored, this->tree_.block(0));
  }
  const Posed<V>& node(const typename Tree::Node& stored) {
    return Base::node(static_cast<std::uint32_t>(&stored - &this->tree_.node(0)));
  }

 private:
  void forget() override { Base::forget(), rows_.forget(), blocks_.forget(); }

  template <std::size_t width, class Stored>
  const Lanes<width>& lanes(MadeOnce<Lanes<width>>& all, const Stored& stored,
                            const Stored& first) {
    using Four = Batch<float, 4>;
    return all(static_cast<std::size_t>(&stored - &first), this->epoch_, [&](Lanes<width>& to) {
      to.size = stored.size;
      for (std::size_t lane = 0; lane < width; lane += 4) {
        Over<V, Four> from;
        for (std::size_t k = 0; k < stored.volume.size(); ++k)
          std::memcpy(reinterpret_cast<char*>(&from) + k * sizeof(Four), &stored.volume[k][lane],
                      sizeof(Four));
        const Over<Posed<V>, Four> in_world = posed(from, this->placement_);
        for (std::size_t k = 0; k < to.volume.size(); ++k)
          std::memcpy(&to.volume[k][lane],
                      reinterpret_cast<const char*>(&in_world) + k * sizeof(Four), sizeof(Four));
      }
      this->count_posed(width);
    });
  }

  MadeOnce<Lanes<4>> rows_;
  MadeOnce<Lanes<16>> blocks_;
};

/// Call a test with the posed volume, the change of frames, the children of the other node, and
/// the sums of sizes.
template <class V, int F>
struct SiblingsInBody {
  using Test = bvlab::SiblingTestOf<V>;
  using Hierarchy = WideHierarchy<V, F>;

  template <class Do>
  static auto with(const typename SiblingCalls<F>::Step& step, const Do& test) {
    const auto& change = change_of<V>(step.change);
    const auto& from = static_cast<const Hierarchy&>(*step.one.tree);
    const auto& lanes = static_cast<const Hierarchy&>(step.tree).children(step.parent);
    const auto posed = [&] {
      const auto& [tree, node, lane] = step.one;
      if (lane == VolumeInTree<F>::none)
        return Test::posed_node(from.node(node).volume, from.node(node).size, change);
      const auto& siblings = from.children(node);
      return Test::posed_node(lane_of<V>(siblings.volumes, lane),
                              float(siblings.size[static_cast<std::size_t>(lane)]), change);
    }();
    return test(posed, change, lanes.volumes, lanes.size + Batch<float, F>(posed.size));
  }
};
template <class V, int F>
struct SiblingsInWorld {
  using Test = PosedTest<Posed<V>>;
  using Hierarchy = WideHierarchy<V, F>;

  template <class Do>
  static auto with(const typename SiblingCalls<F>::Step& step, const Do& test) {
    const auto in_world = [&](std::size_t k) -> PosedSiblings<V, F>& {
      return static_cast<PosedSiblings<V, F>&>(*step.change.in_world[k]);
    };
    const auto& from = static_cast<const Hierarchy&>(*step.one.tree);
    const auto& sizes = static_cast<const Hierarchy&>(step.tree).children(step.parent).size;
    const auto posed = [&]() -> typename Test::PosedNode {
      const auto& [tree, node, lane] = step.one;
      if (lane == VolumeInTree<F>::none) return {in_world(0).node(node), from.node(node).size};
      return {lane_of<Posed<V>>(in_world(0).children(node), lane),
              float(from.children(node).size[static_cast<std::size_t>(lane)])};
    }();
    return test(posed, typename Test::FrameChange(), in_world(1).children(step.parent),
                sizes + Batch<float, F>(posed.size));
  }
};
template <class Frame, int F>
struct CalledSiblings {
  using Test = typename Frame::Test;
  using Step = typename SiblingCalls<F>::Step;
  using S = Batch<float, F>;

  static OverlapLanes<S> overlap(const Step& step) {
    return Frame::with(step, [](const auto&... x) { return Test::template overlap<S>(x...); });
  }
  static GapLanes<S> separation(const Step& step) {
    return Frame::with(step, [](const auto&... x) { return separation_of<Test, S>(x...); });
  }
  static S gaps(const Step& step) {
    return Frame::with(step, [](const auto& posed, const auto& change, const auto& lanes,
                                const S&) { return Test::template gaps<S>(posed, change, lanes); });
  }
};

template <class V>
struct BlocksInBody {
  using Tests = BlockTests<V>;
  using Tree = BlockHierarchy<V>;

  static typename Tests::Four test(const BlockCalls::Four& step) {
    return {static_cast<const typename Tree::Row&>(step.row_a),
            static_cast<const typename Tree::Row&>(step.row_b), change_of<V>(step.change)};
  }
  static typename Tests::One test(const BlockCalls::One& step) {
    return {static_cast<const typename Tree::Node&>(step.one),
            static_cast<const typename Tree::Block&>(step.block), change_of<V>(step.change)};
  }
};
template <class V>
struct BlocksInWorld {
  using Test = PosedTest<Posed<V>>;
  using Tree = BlockHierarchy<V>;
  using In = PosedBlocks<V>;
  static constexpr typename Test::FrameChange none{};

  static auto test(const BlockCalls::Four& step) {
    return FourByFourTest<Posed<V>, Test, typename In::template Lanes<4>>(
        of(step, 0).row(static_cast<const typename Tree::Row&>(step.row_a)),
        of(step, 1).row(static_cast<const typename Tree::Row&>(step.row_b)), none);
  }
  static auto test(const BlockCalls::One& step) {
    const auto& one = static_cast<const typename Tree::Node&>(step.one);
    return OneBySixteenTest<Posed<V>, Test, typename In::template Lanes<16>>(
        of(step, 0).node(one), one.size,
        of(step, 1).block(static_cast<const typename Tree::Block&>(step.block)), none);
  }

 private:
  template <class Step>
  static In& of(const Step& step, std::size_t k) {
    return static_cast<In&>(*step.change.in_world[k]);
  }
};
template <class Frame, class Step>
inline constexpr BlockCalls::Of<Step> called_blocks{
    [](const Step& step, std::size_t part) { return Frame::test(step).overlap(part); },
    [](const Step& step, std::size_t part) { return Frame::test(step).separation(part); },
    [](const Step& step, std::size_t part) { return Frame::test(step).gaps(part); }};

template <class Posed, class Tree, class Base>
std::unique_ptr<PosedTree> posed_tree(const Base& tree) {
  return std::make_unique<Posed>(static_cast<const Tree&>(tree));
}

template <class V, int F, class Frame>
constexpr SiblingCalls<F> sibling_calls(const SiblingCalls<F>* in_world) {
  using Called = CalledSiblings<Frame, F>;
  return {in_world,           posed_tree<PosedSiblings<V, F>, WideHierarchy<V, F>>,
          put_change<V>,      Called::overlap,
          Called::separation, Called::gaps};
}
template <class V, class Frame>
constexpr BlockCalls block_calls(const BlockCalls* in_world) {
  return {in_world, posed_tree<PosedBlocks<V>, BlockHierarchy<V>>, put_change<V>,
          called_blocks<Frame, BlockCalls::Four>, called_blocks<Frame, BlockCalls::One>};
}

}  // namespace called

/// The tests of a tree's volumes.
template <BoundingVolume V, int F>
const SiblingCalls<F>* calls_of(const WideHierarchy<V, F>&) {
  static constexpr auto in_world =
      called::sibling_calls<V, F, called::SiblingsInWorld<V, F>>(nullptr);
  static constexpr auto calls =
      called::sibling_calls<V, F, called::SiblingsInBody<V, F>>(&in_world);
  return &calls;
}
template <BoundingVolume V>
const BlockCalls* calls_of(const BlockHierarchy<V>&) {
  static constexpr auto in_world = called::block_calls<V, called::BlocksInWorld<V>>(nullptr);
  static constexpr auto calls = called::block_calls<V, called::BlocksInBody<V>>(&in_world);
  return &calls;
}

}  // namespace bvlab
