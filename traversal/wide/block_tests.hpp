// SPDX-License-Identifier: BSD-3-Clause
/// The two tests of block hierarchies, in sixteen lanes: four children of a node against four of
/// another, and one volume against the lanes of a block. `part` is a register of the sixteen lanes;
/// `SiblingTest` has the members of sibling_test.hpp for volumes V.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include "hierarchies/wide/block_hierarchy.hpp"
#include "hierarchies/wide/sibling_test.hpp"
#include "traversal/wide/sixteen_lanes.hpp"

namespace bvlab {

namespace detail {
/// A batch of volumes, filled field by field.
template <class V, class Field>
[[gnu::always_inline]] inline Over<V, SixteenLanes> volumes_of_fields(const Field& field) {
  using S = SixteenLanes;
  constexpr std::size_t fields = sizeof(V) / sizeof(float);
  static_assert(sizeof(Over<V, S>) == sizeof(S) * fields);
  Over<V, S> result;
#pragma GCC unroll 32
  for (std::size_t k = 0; k < fields; ++k) {
    const S lanes = field(k);
    std::memcpy(reinterpret_cast<char*>(&result) + sizeof lanes * k, &lanes, sizeof lanes);
  }
  return result;
}
}  // namespace detail

/// Four children of a, posed into b's frame, against four of b.
template <class V, class SiblingTest, class Row>
class FourByFourTest {
  using S = SixteenLanes;
  using FrameChange = typename SiblingTest::FrameChange;

 public:
  const Row &row_a, &row_b;

  [[gnu::always_inline]] FourByFourTest(const Row& a, const Row& b, const FrameChange& into_b)
      : row_a(a), row_b(b), into_b_(into_b) {}

  [[gnu::always_inline]] OverlapLanes<S> overlap(std::size_t part) const {
    return SiblingTest::template overlap<S>(posed(part), into_b_, others(part), sizes(part));
  }
  [[gnu::always_inline]] GapLanes<S> separation(std::size_t part) const {
    return separation_of<SiblingTest, S>(posed(part), into_b_, others(part), sizes(part));
  }
  [[gnu::always_inline]] S gaps(std::size_t part) const {
    return SiblingTest::template gaps<S>(posed(part), into_b_, others(part));
  }

 private:
  struct Unused {};
  using Posed = std::remove_cvref_t<decltype(SiblingTest::in_lanes(
      std::declval<const Over<V, S>&>(), std::declval<const FrameChange&>()))>;
  struct LastPosed {
    std::size_t child = 4;
    Posed volume;
  };
  [[gnu::always_inline]] Posed posed(std::size_t part) const {
    const auto pose = [&]() __attribute__((always_inline))->Posed {
      return SiblingTest::in_lanes(
          detail::volumes_of_fields<V>([&](std::size_t k) __attribute__((always_inline)) {
            return each_of_four(row_a.volume[k].data(), part);
          }),
          into_b_);
    };
    if constexpr (S::size() >= 4) {
      return pose();
    } else {
      const std::size_t child = part * S::size() / 4;
      if (child != last_.child) last_ = {child, pose()};
      return last_.volume;
    }
  }
  [[gnu::always_inline]] Over<V, S> others(std::size_t part) const {
    return detail::volumes_of_fields<V>([&](std::size_t k) __attribute__((always_inline)) {
      return four_repeated(row_b.volume[k].data(), part);
    });
  }
  [[gnu::always_inline]] S sizes(std::size_t part) const {
    return each_of_four(row_a.size.data(), part) + four_repeated(row_b.size.data(), part);
  }

  const FrameChange& into_b_;
  /// Where a register has fewer than four lanes, several hold the same child of a: it is posed
  /// once.
  [[no_unique_address]] mutable std::conditional_t<(S::size() < 4), LastPosed, Unused> last_ = {};
};

/// One volume, posed into the other body's frame, against the lanes of a block.
template <class V, class SiblingTest, class Block>
class OneBySixteenTest {
  using S = SixteenLanes;
  using FrameChange = typename SiblingTest::FrameChange;

 public:
  const Block& block;

  /// `change` is into the frame of the block.
  [[gnu::always_inline]] OneBySixteenTest(const V& one, float size, const Block& lanes,
                                          const FrameChange& change)
      : block(lanes), change_(change), posed_(SiblingTest::posed_node(one, size, change)) {}
  /// Node is that of a tree.
  template <class Node>
  [[gnu::always_inline]] OneBySixteenTest(const Node& one, const Block& lanes,
                                          const FrameChange& change)
      : OneBySixteenTest(one.volume, one.size, lanes, change) {}

  [[gnu::always_inline]] OverlapLanes<S> overlap(std::size_t part) const {
    return SiblingTest::template overlap<S>(posed_, change_, others(part), sizes(part));
  }
  [[gnu::always_inline]] GapLanes<S> separation(std::size_t part) const {
    return separation_of<SiblingTest, S>(posed_, change_, others(part), sizes(part));
  }
  [[gnu::always_inline]] S gaps(std::size_t part) const {
    return SiblingTest::template gaps<S>(posed_, change_, others(part));
  }

 private:
  [[gnu::always_inline]] Over<V, S> others(std::size_t part) const {
    return detail::volumes_of_fields<V>([&](std::size_t k) __attribute__((always_inline)) {
      return of_sixteen(block.volume[k].data(), part);
    });
  }
  [[gnu::always_inline]] S sizes(std::size_t part) const {
    return of_sixteen(block.size.data(), part) + S(posed_.size);
  }

  const FrameChange& change_;
  typename SiblingTest::PosedNode posed_;
};

/// The tests of a tree's volumes in a body's frame.
template <class V>
struct BlockTests {
  using Tree = BlockHierarchy<V>;
  using SiblingTest = SiblingTestOf<V>;
  using Four = FourByFourTest<V, SiblingTest, typename Tree::Row>;
  using One = OneBySixteenTest<V, SiblingTest, typename Tree::Block>;
};

}  // namespace bvlab
