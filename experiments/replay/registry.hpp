// SPDX-License-Identifier: BSD-3-Clause
/// What was compiled into the program: the volumes, strategies and queries of THE lists (or the
/// part of them that was configured), each from units of its own. The tables are generated
/// (registry.cpp.in), so that an entry that is added recompiles itself and the tables alone.
#pragma once

#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/replay/bodies_of.hpp"
#include "experiments/replay/play_entry.hpp"
#include "experiments/replay/query_entry.hpp"
#include "experiments/replay/volume_entry.hpp"
#include "experiments/replay/wide_entry.hpp"

namespace bvlab {

/// In the order of the list.
std::span<const VolumeEntry* const> volume_entries();
/// Strategy by strategy, each under every query.
std::span<const PlayEntry* const> play_entries();
/// Of volumes in wide trees, each under every query.
std::span<const WideEntry* const> wide_entries();
/// In the order of the list.
std::span<const QueryEntry* const> query_entries();
/// One for each volume; specialised for each query.
template <class Query>
std::span<const BodiesEntry<Query>* const> bodies_entries();

/// A name and what it is.
struct Named {
  std::string name, description;
};
/// Whether one of them has that name.
bool has(const std::vector<Named>& all, std::string_view name);
/// The name if one of them has it, else the first of them: a build may lack what is preferred.
std::string name_or_first(std::string_view name, const std::vector<Named>& all);
std::vector<Named> volumes();
std::vector<Named> frames();
/// How the lanes of a register are filled.
std::vector<Named> kernels();
/// Those that a kernel of sixteen lanes is compiled for.
std::vector<Named> wide_volumes(std::string_view kernel);
/// The fan-out with which such a kernel is fastest; 0 where it is not compiled for the volume.
std::uint32_t wide_fan_out(std::string_view volume, std::string_view kernel);
std::vector<Named> strategies();
std::vector<Named> queries();

/// Throws Unusable where the variant wants a tight fit of a volume that has none.
void require_fit(const Variant& variant);

/// Those of that name. Throw Unusable, naming the option and what there is.
const VolumeEntry& volume_entry(std::string_view name);
const PlayEntry& play_entry(std::string_view strategy, std::string_view query);
const WideEntry& wide_entry(std::string_view volume, std::string_view query);
const QueryEntry& query_entry(std::string_view name);

/// Of a volume that exists.
template <class Query>
const BodiesEntry<Query>& bodies_entry(std::string_view volume) {
  for (const auto* entry : bodies_entries<Query>())
    if (entry->volume == volume) return *entry;
  std::abort();
}

}  // namespace bvlab
