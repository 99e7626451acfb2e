// SPDX-License-Identifier: BSD-3-Clause
/// The frame loop that all peers share, so that they are timed as our engine is: every frame all
/// bodies are placed and all pairs asked; building is timed by itself.
#pragma once

#include <algorithm>
#include <chrono>
#include <concepts>
#include <memory>

#include "experiments/runner/replay.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/queries/contacts.hpp"

namespace bvlab {

/// W is a peer's world: W(meshes, objects); place(i, pose); touching(i, j); and, where it lists
/// pairs of triangles, contacts(i, j, found), which may repeat a pair (repeats are dropped when
/// answers are kept, not while the clock runs).
template <class W>
ReplayResult play_peer(std::span<const TriangleMesh> meshes, const Trace& trace,
                       std::string_view query, const ReplayOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  ReplayResult result;
  auto start = Clock::now();
  W world(meshes, trace.objects);
  result.build_seconds = since(start);
  const auto pairs = all_object_pairs(static_cast<std::uint32_t>(trace.objects));
  const bool contacts = query == "contacts";
  if (!contacts && options.keep_answers) result.touching.resize(trace.frames * pairs.size());
  std::vector<Pose> poses(trace.objects);
  std::vector<Contact> found;
  start = Clock::now();
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    for (std::size_t i = 0; i < poses.size(); ++i) world.place(i, poses[i]);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      if (!contacts) {
        const bool touching = world.touching(pairs[p].i, pairs[p].j);
        result.hits += touching;
        if (options.keep_answers) result.touching[frame * pairs.size() + p] = touching;
        continue;
      }
      if constexpr (requires { world.contacts(0, 0, found); }) {
        found.clear();
        world.contacts(pairs[p].i, pairs[p].j, found);
        result.hits += found.size();
        if (options.keep_answers)
          for (const auto& [a, b] : found)
            result.contacts.push_back(
                {static_cast<std::uint32_t>(frame), pairs[p].i, pairs[p].j, a, b});
      }
    }
    if (frame == 0) result.first_seconds = since(start);
  }
  result.seconds = since(start);
  std::sort(result.contacts.begin(), result.contacts.end());
  result.contacts.erase(std::unique(result.contacts.begin(), result.contacts.end()),
                        result.contacts.end());
  return result;
}

}  // namespace bvlab
