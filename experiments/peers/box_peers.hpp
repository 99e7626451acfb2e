// SPDX-License-Identifier: BSD-3-Clause
/// Other libraries' broad phases on the same frames. Each keeps its own objects between frames,
/// updates them from the boxes, and writes the pairs it reports into the same kind of list as ours
/// (PairList), whose memory the system provides as cheaply. What it costs to put the boxes into the
/// library's own form is part of its time, as it is of ours.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "broadphase/box.hpp"

namespace bvlab {

class BoxPeer {
 public:
  virtual ~BoxPeer() = default;
  /// The peer finds out which boxes moved.
  virtual std::span<const Pair> overlapping(Boxes<float> boxes) = 0;
  /// It is told: no other box differs from the last frame.
  virtual std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t>) {
    return overlapping(boxes);
  }
  /// Whether `update` makes use of what it is told.
  virtual bool takes_moved() const { return false; }
};

/// The peer of that name, or nothing.
std::unique_ptr<BoxPeer> make_box_peer(const std::string& name);
std::vector<std::string> box_peer_names();

/// What a folder adds: its names, and what makes the peer of one of them (nothing, of another).
struct BoxLibrary {
  std::unique_ptr<BoxPeer> (*make)(const std::string& name);
  std::vector<std::string> names;
};

}  // namespace bvlab
