// SPDX-License-Identifier: BSD-3-Clause
/// THE list of peers: other libraries that answer the same queries on the same traces. Their
/// headers appear in their own source files and nowhere else.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiments/runner/replay.hpp"

namespace bvlab {

struct Peer {
  std::string_view name;
  std::string_view description;
  /// `query` is "touching" or, where `contacts` says so, "contacts". Counts stay zero.
  ReplayResult (*replay)(std::span<const TriangleMesh> meshes, const Trace& trace,
                         std::string_view query, const ReplayOptions& options);
  bool contacts;
};

std::span<const Peer> peers();

/// "fcl-obb, ..."
std::string peer_names();

/// Null where there is none of that name.
const Peer* peer(std::string_view name);

}  // namespace bvlab
