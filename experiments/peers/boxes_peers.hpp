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
  virtual std::span<const Pair> overlapping(Boxes<float> boxes) = 0;
};

/// The peer of that name, or nothing.
std::unique_ptr<BoxPeer> make_box_peer(const std::string& name);
std::vector<std::string> box_peer_names();

// One translation unit a library; nothing where the name is not one of its own.
std::unique_ptr<BoxPeer> make_cgal_boxes(const std::string& name);
std::unique_ptr<BoxPeer> make_fcl_boxes(const std::string& name);
std::unique_ptr<BoxPeer> make_bullet_boxes(const std::string& name);
std::unique_ptr<BoxPeer> make_embree_boxes(const std::string& name);
std::unique_ptr<BoxPeer> make_ode_boxes(const std::string& name);

}  // namespace bvlab
