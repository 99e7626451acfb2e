// SPDX-License-Identifier: BSD-3-Clause
/// The loops of one volume under one query, as the program sees them while it runs.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <typeinfo>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/volume_entry.hpp"

namespace bvlab {

/// `bodies` makes bodies over hierarchies of that volume, which must outlive them.
template <class Query>
struct LoopsEntry {
  std::string_view volume;
  std::unique_ptr<BodyLoops<Query>> (*bodies)(const AnyHierarchies&, std::size_t objects, Frame);
};

/// Loops over bodies of that volume from fronts that are a strategy's own.
template <class Query>
struct OwnLoopsEntry {
  std::string_view volume;
  AnyLoop (*loop)(const std::type_info& front);  ///< as BodyLoops::loop
};

}  // namespace bvlab
