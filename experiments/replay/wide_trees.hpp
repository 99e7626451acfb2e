// SPDX-License-Identifier: BSD-3-Clause
/// Wide trees of meshes by a variant, and pairs of bodies over them.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "experiments/replay/any_pairs.hpp"
#include "experiments/replay/hierarchies_of.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/shape.hpp"
#include "traversal/wide/any_volume.hpp"
#include "traversal/wide/calls_of.hpp"
#include "traversal/wide/kernels.hpp"

namespace bvlab::detail {

/// Trees of some meshes, and of others when a body of them comes, of one kind (WideTrees).
class AnyTrees {
 public:
  virtual ~AnyTrees() = default;
};

/// The same as pairs of bodies take them.
template <class Tree>
class WideTrees : public AnyTrees {
 public:
  /// The mesh must outlive this.
  virtual ShapeOver<Tree> of(const TriangleMesh& mesh) = 0;
  /// Of trees on demand: all nodes, and those that have been made.
  virtual std::array<std::size_t, 2> nodes() const = 0;

  /// Object i uses mesh i mod the number of meshes.
  std::vector<ShapeOver<Tree>> shapes(std::span<const TriangleMesh> meshes, std::size_t objects) {
    std::vector<ShapeOver<Tree>> shapes;
    for (std::size_t i = 0; i < objects; ++i) shapes.push_back(of(meshes[i % meshes.size()]));
    return shapes;
  }
};

/// Hierarchies, seen as Tree.
template <class Hierarchy, class Tree>
class WideTreesOf final : public WideTrees<Tree> {
 public:
  WideTreesOf(std::span<const TriangleMesh> meshes, const Variant& variant, int threads)
      : variant_(variant), threads_(threads) {
    for (const auto& mesh : meshes) of(mesh);
  }

  ShapeOver<Tree> of(const TriangleMesh& mesh) override {
    const Hierarchy*& known = known_[&mesh];
    if (!known) known = &build(mesh);
    return {&mesh, known};
  }
  std::array<std::size_t, 2> nodes() const override {
    std::array<std::size_t, 2> sum{};
    if constexpr (requires { all_[0].made(); })
      for (const auto& hierarchy : all_) sum[0] += hierarchy.known(), sum[1] += hierarchy.made();
    return sum;
  }

 private:
  const Hierarchy& build(const TriangleMesh& mesh) {
    if constexpr (std::is_same_v<Hierarchy, Tree> &&
                  requires { Hierarchy::on_demand(mesh, variant_.leaf_size); })
      if (variant_.build == builds::OnDemand::name && variant_.fan_out == Hierarchy::fan_out)
        return all_.emplace_back(Hierarchy::on_demand(mesh, variant_.leaf_size));
    Threads several(threads_);
    // Leaves are made while the tree is collapsed.
    Variant down_to_triangles = variant_;
    down_to_triangles.leaf_size = 1;
    constexpr std::uint32_t most = Hierarchy::fan_out;
    WideTopology topology = collapsed(mesh, topology_of(mesh, down_to_triangles), variant_.fan_out,
                                      std::min<std::uint32_t>(variant_.leaf_size, most));
    if (variant_.fan_out > most) topology = in_rows(topology, most);
    Hierarchy& built = all_.emplace_back(mesh, topology, fit_of(variant_), several);
    if constexpr (!std::is_same_v<Hierarchy, Tree>) built.calls = calls_of(built);
    return built;
  }

  Variant variant_;
  int threads_;
  std::deque<Hierarchy> all_;  // a deque: bodies refer to its elements while it grows
  std::unordered_map<const TriangleMesh*, const Hierarchy*> known_;
};

/// The lanes of siblings for which a kernel is compiled: of `siblings` as many as a register has,
/// and, where these are fewer, sixteen; of `mixed` four in a row.
template <class Kernel>
inline constexpr int kernel_lanes = native_fan_out<float>;
template <>
inline constexpr int kernel_lanes<MixedKernel> = TreeInBlocks::fan_out;
template <class Kernel>
inline constexpr int most_kernel_lanes = 16;
template <>
inline constexpr int most_kernel_lanes<MixedKernel> = kernel_lanes<MixedKernel>;

template <class V, class Kernel, int lanes = kernel_lanes<Kernel>>
using TreeOf = typename Kernel::template Hierarchy<V, lanes>;

/// Volumes that these kernels take: over float, with a sibling test of their own or
/// PosedSiblingTest.
template <class V>
concept WideVolume = std::same_as<typename V::scalar, float> &&
    (HasSiblingTest<V> || (std::same_as<Posed<V>, V> && PlacedRelatively<V>));

/// Pairs over trees whose volume the loops do not know; bodies are of the meshes in turn. Compiled
/// once for each query (wide_any.cpp.in).
template <class Query>
std::unique_ptr<AnyPairs<Query>> pairs_over_any(const std::shared_ptr<AnyTrees>& trees,
                                                std::span<const TriangleMesh> meshes,
                                                std::size_t objects, const Variant& variant);

}  // namespace bvlab::detail
