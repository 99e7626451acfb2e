// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/boxes_peers.hpp"

namespace bvlab {

std::unique_ptr<BoxPeer> make_box_peer(const std::string& name) {
  for (const auto make :
       {make_cgal_boxes, make_fcl_boxes, make_bullet_boxes, make_embree_boxes, make_ode_boxes})
    if (auto peer = make(name)) return peer;
  return nullptr;
}

std::vector<std::string> box_peer_names() {
  return {"cgal",         "cgal-1000",   "cgal-parallel", "fcl-tree", "fcl-ssap", "fcl-sap",
          "fcl-interval", "bullet-dbvt", "bullet-sweep",  "embree",   "ode-hash", "ode-sap"};
}

}  // namespace bvlab
