// SPDX-License-Identifier: BSD-3-Clause
/// Cells of a definition as something to run: which of them share a trace, the scene of one, and
/// the answers to it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiments/definitions/definition.hpp"
#include "experiments/replay/replay.hpp"
#include "experiments/scenes/trace.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

/// What cells with the same trace have in common.
struct Prepared {
  std::vector<TriangleMesh> meshes;
  Trace trace;
};
Prepared prepared(const Cell& cell);

/// Parameters that say how a trace is answered; all the others say which trace it is.
bool is_of_variant(const std::string& name);

/// Of a cell of `cells_with_answers`, in which a configuration is spelled out.
Variant variant_of(const Cell& cell);

/// What the answers to a query are compared with: the engine's default variant, with the first
/// volume and strategy of a build that lacks those of the default.
Variant reference_for(const std::string& query);

/// By the cell's peer, or by us. Where a configuration chooses by the motion, the choice is part of
/// what comes before the first frame, and so of `build_seconds`.
ReplayResult answered(const Prepared& ready, const Cell& cell, const ReplayOptions& options);

/// Throws Unusable for names that do not exist and values that cannot be.
void check(const Cell& cell);

/// Not every peer answers every query, and not every one is compiled: such cells are left out.
bool has_answer(const Cell& cell);

/// A peer has a volume, a strategy and so on of its own: what a cell says of ours is cleared. So is
/// a configuration's replaced. Cells that then say the same are one.
enum class AbsentPeers { left_out, kept };
std::vector<Cell> cells_with_answers(const Definition& definition,
                                     AbsentPeers absent = AbsentPeers::left_out);

/// Cells that share a trace and a query, as indices, in the order in which a definition has them.
std::vector<std::vector<std::size_t>> traces_of(const std::vector<Cell>& cells);

}  // namespace bvlab
