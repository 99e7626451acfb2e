// SPDX-License-Identifier: BSD-3-Clause
/// THE list of peers: other libraries that answer the same queries on the same traces. A peer is a
/// folder beside this file (see adding_a_peer.md); a library's headers appear there and nowhere
/// else. Settings are the libraries' own, but for what a description or the folder's page names;
/// a record's machine.json says how a library was compiled.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiments/replay/replay.hpp"

namespace bvlab {

struct Peer {
  std::string_view name;
  std::string_view description;
  /// The queries it answers, by name, with blanks between.
  std::string_view queries;
  /// `query` is one of those. Counts stay zero where the library does not tell them.
  ReplayResult (*replay)(std::span<const TriangleMesh> meshes, const Trace& trace,
                         std::string_view query, const ReplayOptions& options);
  /// It takes convex solids, not surfaces: what is inside another touches it.
  bool takes_solids = false;

  bool answers(std::string_view query) const;
};

std::span<const Peer> peers();

/// The libraries that were absent when the program was built, with blanks between: their peers are
/// left out.
std::string_view absent_peer_libraries();

/// "fcl-obb, ..."
std::string peer_names();

/// Whether a peer of that name would be there if its library had been when the program was built.
bool is_absent_peer(std::string_view name);

/// Null where there is none of that name.
const Peer* peer(std::string_view name);

}  // namespace bvlab
