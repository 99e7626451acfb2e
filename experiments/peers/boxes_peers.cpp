// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/boxes_peers.hpp"

namespace bvlab {
namespace {

struct Library {
  std::unique_ptr<BoxPeer> (*make)(const std::string& name);
  std::vector<std::string> names;
};

const std::vector<Library>& libraries() {
  static const std::vector<Library> all {
#if BVLAB_CGAL && BVLAB_TBB
    {make_cgal_boxes, {"cgal", "cgal-1000", "cgal-parallel"}},
#endif
#if BVLAB_FCL
        {make_fcl_boxes, {"fcl-tree", "fcl-ssap", "fcl-sap", "fcl-interval"}},
#endif
#if BVLAB_BULLET
        {make_bullet_boxes, {"bullet-dbvt", "bullet-sweep"}},
#endif
#if BVLAB_EMBREE
        {make_embree_boxes, {"embree"}},
#endif
#if BVLAB_ODE
        {make_ode_boxes, {"ode-hash", "ode-sap"}},
#endif
  };
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
