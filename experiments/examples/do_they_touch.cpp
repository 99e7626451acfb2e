// SPDX-License-Identifier: BSD-3-Clause
/// Do two meshes touch, and where? A ring is moved towards another, and asked at each place.
#include <cstdio>

#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "ring.hpp"
#include "traversal/body.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/traverse.hpp"

using namespace bvlab;
using Volume = Obb<float>;      // any header of hierarchies/volumes
using Lanes = Batch<float, 8>;  // eight tests of volumes at a time

int main() {
  const TriangleMesh mesh = ring();
  const Hierarchy<Volume> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 2));

  Body<Volume> still(mesh, hierarchy), moving(mesh, hierarchy);
  still.move(Pose(), Vec3<double>::Zero());
  Workspace workspace;
  NotCounting counter;
  for (const double x : {3.0, 2.4, 2.0, 1.0}) {
    // Where it is, and a quaternion: a quarter turn about the x axis links the rings at x = 1.
    moving.move(pose_from({x, 0, 0}, 1, 1, 0, 0).value(), Vec3<double>::Zero());
    Touching touching;
    traverse_from_roots<Lanes>(still, moving, touching, counter, workspace);
    std::vector<Contact> found;  // triangle of the one, triangle of the other
    Contacts contacts(found);
    traverse_from_roots<Lanes>(still, moving, contacts, counter, workspace);
    std::printf("at %.1f: %s, %s\n", x, touching.touching() ? "touching" : "apart",
                found.empty() ? "no triangles" : "some triangles");
  }
}
