// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies as Python says and sees them.
#pragma once

#include <memory>
#include <vector>

#include "experiments/python/arrays.hpp"
#include "experiments/scenes/pair_files.hpp"
#include "traversal/nearest_points.hpp"

namespace bvlab {

/// From arrays of whole numbers, or None. Throws Unusable, naming the argument.
PairArrays pair_arrays(const py::object& pairs, const py::object& without,
                       const py::object& groups);

/// (k, 2) uint32.
py::array_t<std::uint32_t> rows_of(std::vector<ObjectPair>&& pairs);

/// Chosen pairs, from what `rows_of` made. Throws Unusable for anything else.
std::shared_ptr<const std::vector<ObjectPair>> chosen_rows(const py::object& rows);

/// An array of that shape of records: triangles, uint32 (2,), and points, float64 (2, 3).
py::array records_of(std::vector<NearestPair>&& nearest, std::vector<py::ssize_t> shape);

}  // namespace bvlab
