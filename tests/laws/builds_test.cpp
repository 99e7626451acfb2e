// SPDX-License-Identifier: BSD-3-Clause
/// Trees built by several threads are those of one, bit for bit.
#include "hierarchies/builds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "experiments/scenes/formula_mesh.hpp"
#include "hierarchies/hierarchy.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "hierarchies/wide/collapse.hpp"
#include "traversal/recommended.hpp"

namespace bvlab {
namespace {

std::vector<TriangleMesh> meshes() {
  std::vector<TriangleMesh> all{formula_mesh("torus", 6000), formula_mesh("icosphere", 5120),
                                formula_mesh("star", 1100), formula_mesh("box", 12)};
  // Many triangles in one place, which no plane divides.
  TriangleMesh heap = formula_mesh("box", 12);
  for (int k = 0; k < 8; ++k)
    heap.triangles.insert(heap.triangles.end(), heap.triangles.begin(), heap.triangles.end());
  all.push_back(heap);
  return all;
}

void expect_same(const Topology& one, const Topology& more) {
  EXPECT_TRUE(std::ranges::equal(one.nodes, more.nodes, [](const auto& a, const auto& b) {
    return a.first == b.first && a.count == b.count;
  }));
  EXPECT_EQ(one.primitives, more.primitives);
}

TEST(Builds, ThreadsChangeNoTopology) {
  for (const auto& mesh : meshes())
    for (const SplitAxis axis : {SplitAxis::longest, SplitAxis::principal})
      for (const SplitAt at : {SplitAt::median, SplitAt::mean, SplitAt::middle})
        for (const std::uint32_t leaf_size : {1u, 3u, 400u}) {
          const TopDown build{axis, at, leaf_size};
          const Topology one = build(mesh);
          for (const int count : {2, 3, 7}) {
            Threads threads(count);
            expect_same(one, build(mesh, threads));
          }
        }
}

TEST(Builds, ThreadsChangeNoSplits) {
  for (const auto& mesh : meshes())
    for (const std::uint32_t leaf_size : {1u, 3u, 400u})
      for (const int count : {2, 3, 7}) {
        Threads threads(count);
        using Build = builds::TopDownSurfaceArea;
        expect_same(Build::topology(mesh, leaf_size), Build::topology(mesh, leaf_size, threads));
      }
}

TEST(Builds, ThreadsChangeNoTopologyFromBelow) {
  for (const auto& mesh : meshes())
    for (const std::uint32_t radius : {4u, 16u}) {
      const BottomUp build{3, radius};
      const Topology one = build(mesh);
      for (const int count : {2, 3, 7}) {
        Threads threads(count);
        expect_same(one, build(mesh, threads));
      }
    }
}

/// How many levels are below the root.
std::size_t depth(const Topology& topology) {
  std::size_t deepest = 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> open{{0, 0}};
  while (!open.empty()) {
    const auto [node, level] = open.back();
    open.pop_back();
    deepest = std::max(deepest, level);
    if (topology.nodes[node].count > 0) continue;
    for (const std::uint32_t k : {0u, 1u})
      open.emplace_back(topology.nodes[node].first + k, level + 1);
  }
  return deepest;
}

void expect_each_once(Topology topology, std::size_t triangles) {
  std::ranges::sort(topology.primitives);
  ASSERT_EQ(topology.primitives.size(), triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) ASSERT_EQ(topology.primitives[i], i);
}

/// Triangles in a row: the next one starts `step(i)` after the i-th.
template <class Step>
TriangleMesh row_of(std::uint32_t count, const Step& step) {
  TriangleMesh mesh;
  double x = 0;
  for (std::uint32_t i = 0; i < count; ++i, x += step(i)) {
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (const Vec3<double>& corner : {Vec3<double>(x, 0, 0), {x + 1, 0, 0}, {x, 1, 0}})
      mesh.vertices.push_back(corner);
  }
  return mesh;
}

/// A round in which one pair merges leaves a list, and takes as long as all the rest.
TEST(Builds, EqualCostsMakeNoList) {
  constexpr std::uint32_t count = 20000;
  const auto look = [](const TriangleMesh& mesh, std::size_t levels) {
    const Topology topology = BottomUp{}(mesh);
    expect_each_once(topology, count);
    EXPECT_LE(depth(topology), levels);
    Threads threads(3);
    expect_same(topology, BottomUp{}(mesh, threads));
  };
  look(row_of(count, [](auto) { return 0.0; }), 64);                // one place
  look(row_of(count, [](auto) { return 2.0; }), 64);                // evenly spaced
  look(row_of(count, [](auto i) { return 4.0 - i * 1e-4; }), 400);  // each nearer to the next
  look(row_of(count, [](auto i) { return i % 2 ? 1e200 : 1e190; }), 400);  // costs that overflow
}

/// Ranges whose inverse, or which themselves, overflow.
TEST(Builds, RangesBeyondNumbersAreSplit) {
  for (const double scale : {4.9e-324, 1e-310, 1e307, 1.7e308}) {
    TriangleMesh mesh = formula_mesh("icosphere", 320);
    for (auto& vertex : mesh.vertices) vertex *= scale;
    for (const SplitAt at : {SplitAt::median, SplitAt::mean, SplitAt::middle})
      expect_each_once(TopDown{SplitAxis::longest, at, 1}(mesh), mesh.triangles.size());
    expect_each_once(builds::TopDownSurfaceArea::topology(mesh, 1), mesh.triangles.size());
    expect_each_once(BottomUp{1}(mesh), mesh.triangles.size());
  }
}

using Box3 = Eigen::AlignedBox3d;
double half_surface_of(const Box3& box) {
  const Vec3<double> d = box.sizes();
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}
Box3 box_of(const TriangleMesh& mesh, std::span<const std::uint32_t> primitives) {
  Box3 box;
  for (const std::uint32_t k : primitives)
    for (const auto& corner : mesh.corners(k)) box.extend(corner);
  return box;
}
/// The primitives below each node.
std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges_of(const Topology& topology) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges(topology.nodes.size());
  for (std::size_t i = ranges.size(); i-- > 0;) {
    const auto& [first, count] = topology.nodes[i];
    ranges[i] = count ? std::pair(first, first + count)
                      : std::pair(ranges[first].first, ranges[first + 1].second);
  }
  return ranges;
}

/// No plane between two of 16 bins, along any axis, would cost less than the one chosen: up to 1 %,
/// since boxes and planes are rounded to float, and what lies on a plane may be on either side.
TEST(Builds, SurfaceAreaCutsCostLeast) {
  for (const auto& mesh : meshes()) {
    const Topology topology = builds::TopDownSurfaceArea::topology(mesh, 1);
    const auto ranges = ranges_of(topology);
    const auto cost = [&](std::span<const std::uint32_t> part) {
      return half_surface_of(box_of(mesh, part)) * static_cast<double>(part.size());
    };
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const auto [begin, end] = ranges[i];
      if (topology.nodes[i].count > 0 || end - begin > RangeSplits::sampled) continue;
      std::vector<std::uint32_t> all(topology.primitives.begin() + begin,
                                     topology.primitives.begin() + end);
      const auto centre = [&](std::uint32_t k) -> Vec3<double> {
        return box_of(mesh, std::span(&k, 1)).center();
      };
      Box3 centres;
      for (const auto k : all) centres.extend(centre(k));
      const auto middle = ranges[topology.nodes[i].first].second - begin;
      const double chosen =
          cost(std::span(all).first(middle)) + cost(std::span(all).subspan(middle));
      double least = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis)
        for (int k = 1; k < 16 && centres.sizes()[axis] > 1e-6 * centres.sizes().norm(); ++k) {
          const double at = centres.min()[axis] + centres.sizes()[axis] * k / 16;
          const auto right =
              std::ranges::partition(all, [&](auto t) { return centre(t)[axis] < at; });
          const auto count = all.size() - right.size();
          if (count == 0 || count == all.size()) continue;
          least = std::min(least,
                           cost(std::span(all).first(count)) + cost(std::span(all).subspan(count)));
        }
      EXPECT_LE(chosen, least * 1.01) << i << ": " << all.size();
    }
  }
}

/// The least total surface of wide nodes, by trying every division between children.
class LeastSurface {
 public:
  LeastSurface(const TriangleMesh& mesh, const Topology& binary, std::uint32_t fan_out,
               std::uint32_t leaf_size)
      : mesh_(mesh),
        binary_(binary),
        ranges_(ranges_of(binary)),
        fan_out_(fan_out),
        leaf_size_(leaf_size) {}

  double of(std::uint32_t b, std::uint32_t roots) {
    if (const auto known = known_.find({b, roots}); known != known_.end()) return known->second;
    const auto [begin, end] = ranges_[b];
    const double surface =
        half_surface_of(box_of(mesh_, std::span(binary_.primitives).subspan(begin, end - begin)));
    if (binary_.nodes[b].count > 0 || end - begin <= leaf_size_)
      return known_[{b, roots}] = surface;
    double least = surface + divided(b, fan_out_);
    if (roots > 1) least = std::min(least, divided(b, roots));
    return known_[{b, roots}] = least;
  }

 private:
  /// Of a subtree that is replaced by at least two nodes, `roots` at most.
  double divided(std::uint32_t b, std::uint32_t roots) {
    double least = std::numeric_limits<double>::infinity();
    const std::uint32_t first = binary_.nodes[b].first;
    for (std::uint32_t k = 2; k <= roots; ++k)
      for (std::uint32_t left = 1; left < k; ++left)
        least = std::min(least, of(first, left) + of(first + 1, k - left));
    return least;
  }
  const TriangleMesh& mesh_;
  const Topology& binary_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges_;
  std::uint32_t fan_out_, leaf_size_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> known_;
};

TEST(Builds, CollapsedTreesHaveTheLeastSurface) {
  for (const auto& mesh : {formula_mesh("torus", 300), formula_mesh("star", 200)})
    for (const std::uint32_t binary_leaf : {1u, 2u})
      for (const auto& [fan_out, leaf_size] :
           {std::pair{2u, 1u}, {4u, 4u}, {8u, 3u}, {16u, 4u}, {16u, 1u}}) {
        const Topology binary = builds::TopDownSurfaceArea::topology(mesh, binary_leaf);
        const WideTopology wide = collapsed(mesh, binary, fan_out, leaf_size);
        double total = 0;
        for (const auto& node : wide.nodes) {
          total += half_surface_of(
              box_of(mesh, std::span(wide.primitives).subspan(node.begin, node.end - node.begin)));
          EXPECT_LE(node.leaf ? 1u : node.count, fan_out);
        }
        const double least = LeastSurface(mesh, binary, fan_out, leaf_size).of(0, 1);
        EXPECT_NEAR(total, least, 1e-12 * least) << fan_out << ' ' << leaf_size;
      }
}

/// Bits, so that not even a zero changes its sign.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

template <class V>
void expect_threads_change_no_volume(const TriangleMesh& mesh, Fit fit) {
  const Topology topology = builds::TopDownPrincipal::topology(mesh, 1);
  const Hierarchy<V> one(mesh, topology, fit);
  for (const int count : {2, 3, 7}) {
    Threads threads(count);
    const Hierarchy<V> more(mesh, topology, fit, threads);
    ASSERT_EQ(one.size(), more.size());
    for (std::uint32_t i = 0; i < one.size(); ++i) {
      EXPECT_TRUE(same_bits(one.volume(i), more.volume(i))) << V::name << ' ' << i;
      EXPECT_EQ(one.node(i).size, more.node(i).size);
      EXPECT_EQ(one.above(i).least, more.above(i).least);
    }
    EXPECT_EQ(one.extent().reach, more.extent().reach);
  }
}

TEST(Builds, ThreadsChangeNoVolume) {
  for (const char* shape : {"torus", "star"}) {
    const auto mesh = formula_mesh(shape, 1100);
    expect_threads_change_no_volume<Sphere<float>>(mesh, Fit::published);
    expect_threads_change_no_volume<Obb<float>>(mesh, Fit::published);
    expect_threads_change_no_volume<Obb<float>>(mesh, Fit::tight);
  }
}

TEST(Builds, ThreadsChangeNoWideHierarchy) {
  using Whole = WideTrees<SlabBox<float>, native_fan_out<float>, SiblingsKernel,
                          builds::TopDownSurfaceArea, Fit::published, native_fan_out<float>>;
  for (const auto& mesh : meshes()) {
    const auto one = Whole::hierarchy(mesh);
    for (const int threads : {2, 3, 7}) {
      const auto more = Whole::hierarchy(mesh, threads);
      ASSERT_EQ(one.size(), more.size());
      EXPECT_EQ(one.reach(), more.reach());
      for (std::uint32_t i = 0; i < one.size(); ++i) {
        const auto &a = one.node(i), &b = more.node(i);
        EXPECT_TRUE(a.first == b.first && a.lanes == b.lanes && a.leaf == b.leaf &&
                    a.size == b.size && same_bits(a.volume, b.volume));
        EXPECT_TRUE(same_bits(one.children(i), more.children(i)));
        if (!a.leaf) continue;
        EXPECT_TRUE(same_bits(one.corners(a.first), more.corners(a.first)));
        for (std::uint32_t k = 0; k < Whole::fan_out; ++k)
          EXPECT_EQ(one.triangle(a.first + k), more.triangle(a.first + k));
        EXPECT_EQ(one.leaf_of(a.first), more.leaf_of(a.first));
      }
      const auto &a = one.supports().table(), &b = more.supports().table();
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(same_bits(a[k], b[k]));
    }
  }
}

}  // namespace
}  // namespace bvlab
