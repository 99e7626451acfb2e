// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/box_peers.hpp"

#include "experiments/peers/found.hpp"

namespace bvlab {

#define BVLAB_DECLARED(library) BoxLibrary library##_boxes();
#define BVLAB_LISTED(library) library##_boxes(),
BVLAB_BOX_PEERS(BVLAB_DECLARED)

namespace {

const std::vector<BoxLibrary>& libraries() {
  static const std::vector<BoxLibrary> all{BVLAB_BOX_PEERS(BVLAB_LISTED)};
  return all;
}

}  // namespace

std::unique_ptr<BoxPeer> make_box_peer(const std::string& name) {
  for (const auto& library : libraries())
    if (auto peer = library.make(name)) return peer;
  return nullptr;
}

std::vector<std::string> box_peer_names() {
  std::vector<std::string> names;
  for (const auto& library : libraries())
    names.insert(names.end(), library.names.begin(), library.names.end());
  return names;
}

}  // namespace bvlab
