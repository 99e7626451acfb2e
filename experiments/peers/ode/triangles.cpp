// SPDX-License-Identifier: BSD-3-Clause
#include <ode/ode.h>

#include "experiments/peers/triangle_tests.hpp"

namespace bvlab {
namespace {

/// Its test cannot be called but through meshes, which must have two triangles: here the same one
/// twice.
void decide_ode(TriangleTestPeer::Pairs pairs, std::uint8_t* verdicts) {
  static const bool ready = dInitODE2(0) != 0;
  (void)ready;
  dAllocateODEDataForThread(dAllocateMaskAll);
  constexpr dTriIndex corners[] = {0, 1, 2, 0, 1, 2};
  const dTriMeshDataID data[] = {dGeomTriMeshDataCreate(), dGeomTriMeshDataCreate()};
  for (const auto& pair : pairs) {
    dGeomID geometries[2];
    for (int i = 0; i < 2; ++i) {
      dGeomTriMeshDataBuildDouble(data[i], pair[i][0].data(), 3 * sizeof(double), 3, corners, 6,
                                  3 * sizeof corners[0]);
      geometries[i] = dCreateTriMesh(nullptr, data[i], nullptr, nullptr, nullptr);
    }
    dContactGeom contact;
    *verdicts++ = dCollide(geometries[0], geometries[1], 1, &contact, sizeof contact) > 0;
    for (const auto geometry : geometries) dGeomDestroy(geometry);
  }
  for (const auto each : data) dGeomTriMeshDataDestroy(each);
}

}  // namespace

std::span<const TriangleTestPeer> ode_triangles() {
  static constexpr TriangleTestPeer list[] = {
      {"ode", "OPCODE in float32; time includes making a mesh of each triangle", decide_ode},
  };
  return list;
}

}  // namespace bvlab
