// SPDX-License-Identifier: BSD-3-Clause
/// Bodies of one volume under one query, as the program sees them while it runs.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/hierarchies_of.hpp"
#include "traversal/bodies.hpp"

namespace bvlab {

/// `bodies` makes bodies over hierarchies of that volume, which must outlive them.
template <class Query>
struct BodiesEntry {
  std::string_view volume;
  std::unique_ptr<BodiesInside<Query>> (*bodies)(const AnyHierarchies&, std::size_t objects, Frame);
};

namespace detail {

template <BoundingVolume V, class Query>
class BodiesOver final : public BodiesInside<Query> {
 public:
  static constexpr int W = BodiesInside<Query>::W;

  BodiesOver(std::span<const Shape<V>> shapes, Frame frame) : bodies_(shapes, frame) {}

  std::size_t size() const override { return bodies_.size(); }
  TreeBody& body(std::size_t i) override { return bodies_[i]; }
  void add(const OneOfHierarchies& of_mesh) override {
    const auto& all = static_cast<const HierarchiesOf<V>&>(*of_mesh.hierarchies);
    bodies_.add(all.shape(of_mesh.mesh));
  }
  TestsBetween<Query> tests_between() const override { return bvlab::tests_between<W, V, Query>; }
  void cull_roots(std::span<const ObjectPair> pairs, std::span<const std::uint32_t> fresh,
                  Query& query, Counting& counter, std::uint8_t* apart) override {
    bodies_.cull_roots(pairs, fresh, query, counter, apart);
  }

 private:
  Bodies<bvlab::detail::OfWidth<typename V::scalar, W>, V> bodies_;
};

template <BoundingVolume V, class Query>
std::unique_ptr<BodiesInside<Query>> bodies_over(const AnyHierarchies& hierarchies,
                                                 std::size_t objects, Frame frame) {
  return std::make_unique<BodiesOver<V, Query>>(
      static_cast<const HierarchiesOf<V>&>(hierarchies).shapes(objects), frame);
}

}  // namespace detail

template <BoundingVolume V, class Query>
constexpr BodiesEntry<Query> bodies_of() {
  return {V::name, detail::bodies_over<V, Query>};
}

}  // namespace bvlab
