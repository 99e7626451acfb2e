// SPDX-License-Identifier: BSD-3-Clause
/// ODE's triangle meshes: OPCODE's trees of boxes in float32, triangles in float64.
#include <ode/ode.h>

#include "experiments/peers/play_peer.hpp"

namespace bvlab {
namespace {

class OdeWorld {
 public:
  OdeWorld(std::span<const TriangleMesh> meshes, std::size_t objects) : meshes_(meshes) {
    static const bool ready = dInitODE2(0);
    // Needed once in each thread that asks.
    thread_local const bool ready_here = dAllocateODEDataForThread(dAllocateMaskAll);
    (void)ready, (void)ready_here;
    for (const auto& mesh : meshes_) {
      data_.push_back(dGeomTriMeshDataCreate());
      // The world refers to the meshes: both outlive it.
      dGeomTriMeshDataBuildDouble(data_.back(), mesh.vertices.data(), sizeof(Vec3<double>),
                                  static_cast<int>(mesh.vertices.size()), mesh.triangles.data(),
                                  static_cast<int>(3 * mesh.triangles.size()),
                                  3 * sizeof(std::uint32_t));
    }
    for (std::size_t i = 0; i < objects; ++i)
      bodies_.push_back(
          dCreateTriMesh(nullptr, data_[i % data_.size()], nullptr, nullptr, nullptr));
  }
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  ~OdeWorld() {
    for (auto* body : bodies_) dGeomDestroy(body);
    for (auto* data : data_) dGeomTriMeshDataDestroy(data);
  }

  void place(std::size_t i, const Pose& pose) {
    dMatrix3 rotation{};  // rows of four
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        rotation[4 * row + column] = pose.rotation(row, column);
    const auto& t = pose.translation;
    dGeomSetRotation(bodies_[i], rotation);
    dGeomSetPosition(bodies_[i], t[0], t[1], t[2]);
  }

  bool touching(std::size_t i, std::size_t j) {
    dContactGeom contact;
    return dCollide(bodies_[i], bodies_[j], static_cast<int>(CONTACTS_UNIMPORTANT | 1u), &contact,
                    sizeof contact) > 0;
  }

 private:
  std::span<const TriangleMesh> meshes_;
  std::vector<dTriMeshDataID> data_;
  std::vector<dGeomID> bodies_;
};

}  // namespace

std::span<const Peer> ode_peers() {
  static constexpr Peer list[] = {
      {"ode", "ODE 0.16.2: trimesh (OPCODE), boxes in float32; one contact, not refined",
       "touching", play_peer<OdeWorld>},
  };
  return list;
}

}  // namespace bvlab
