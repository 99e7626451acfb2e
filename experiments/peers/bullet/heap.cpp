// SPDX-License-Identifier: BSD-3-Clause
/// Writes a motion that nobody here made: meshes dropped into a pit, as Bullet's own simulation of
/// rigid bodies moves them. A program of its own, where Bullet is there:
///
///     bvlab_heap --out heap.npy [--mesh bunny] [--polygons 500] [--objects 12] [--frames 300] ...
///
/// Bodies are GImpact meshes of one mass, their centres of mass those of the mesh's surface;
/// friction, damping, solver and time steps are Bullet's defaults (sixtieths of a second, in four
/// parts). Lengths are in radii of the mesh while Bullet computes, gravity 20 of them per second
/// squared. The same numbers give the same motion by the same build of Bullet: it computes in
/// float32, in one thread.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <cstdio>
#include <memory>
#include <vector>

#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/random.hpp"

namespace bvlab {
namespace {

struct Heap {
  std::string mesh = "bunny", out;
  std::size_t polygons = 500, objects = 12, frames = 300;
  double side = 4;  ///< of the pit's floor, in radii
  std::uint64_t seed = 1;
};

/// The mesh about the centre of mass of its surface, in its own radii.
struct Body {
  std::vector<btScalar> vertices;
  std::vector<int> indices;
  Vec3<double> centre = Vec3<double>::Zero();
  double radius = 0;
  std::unique_ptr<btTriangleIndexVertexArray> array;
  std::unique_ptr<btGImpactMeshShape> shape;

  explicit Body(const TriangleMesh& mesh) {
    double area = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto [a, b, c] = mesh.corners(i);
      const double part = (b - a).cross(c - a).norm();
      centre += part * (a + b + c) / 3, area += part;
    }
    if (!(area > 0)) throw Unusable("--mesh: has no area");
    centre /= area;
    for (const auto& v : mesh.vertices) radius = std::max(radius, (v - centre).norm());
    for (const auto& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis)
        vertices.push_back(static_cast<btScalar>((v[axis] - centre[axis]) / radius));
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle) indices.push_back(static_cast<int>(v));
    array = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), indices.data(), 3 * sizeof(int),
        static_cast<int>(mesh.vertices.size()), vertices.data(), 3 * sizeof(btScalar));
    shape = std::make_unique<btGImpactMeshShape>(array.get());
    shape->setMargin(btScalar(0.01));
    shape->updateBound();
  }
};

class Simulation {
 public:
  Simulation(const Heap& heap, const TriangleMesh& mesh)
      : heap_(heap),
        body_(mesh),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    world_.setGravity({0, 0, -20});
    const auto half = static_cast<btScalar>(heap.side / 2);
    wall({0, 0, 1}, 0);
    wall({1, 0, 0}, -half), wall({-1, 0, 0}, -half), wall({0, 1, 0}, -half),
        wall({0, -1, 0}, -half);
    drop();
  }
  ~Simulation() {
    for (auto& each : bodies_) world_.removeRigidBody(each.get());
  }

  Array<double> run() {
    Array<double> trace{{heap_.frames, heap_.objects, 7}, {}};
    for (std::size_t frame = 0; frame < heap_.frames; ++frame) {
      for (std::size_t i = 0; i < heap_.objects; ++i) append(*bodies_[first_ + i], trace.data);
      world_.stepSimulation(btScalar(1) / 60, 4, btScalar(1) / 240);
    }
    return trace;
  }

 private:
  void wall(const btVector3& normal, btScalar offset) {
    walls_.push_back(std::make_unique<btStaticPlaneShape>(normal, offset));
    add(0, walls_.back().get(), btTransform::getIdentity());
    ++first_;
  }

  /// In layers above the floor, four to a layer at most, turned at random.
  void drop() {
    Random random(heap_.seed);
    const double room = heap_.side / 2;
    const auto across = std::max<std::size_t>(1, static_cast<std::size_t>(heap_.side / 2.1));
    for (std::size_t i = 0; i < heap_.objects; ++i) {
      const std::size_t column = i % (across * across), layer = i / (across * across);
      const double step = heap_.side / static_cast<double>(across);
      const auto at = [&](std::size_t k) { return -room + (static_cast<double>(k) + 0.5) * step; };
      btTransform start;
      start.setOrigin({static_cast<btScalar>(at(column % across)),
                       static_cast<btScalar>(at(column / across)),
                       static_cast<btScalar>(1.2 + 2.1 * static_cast<double>(layer))});
      btQuaternion turn;
      do turn = {number(random), number(random), number(random), number(random)};
      while (turn.length2() < btScalar(0.01) || turn.length2() > 1);
      start.setRotation(turn.normalized());
      add(1, body_.shape.get(), start);
    }
  }
  static btScalar number(Random& random) { return static_cast<btScalar>(random.uniform(-1, 1)); }

  void add(btScalar mass, btCollisionShape* shape, const btTransform& start) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = start;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
  }

  /// The pose of the mesh's own frame, in its own units.
  void append(const btRigidBody& body, std::vector<double>& data) const {
    const btTransform& transform = body.getWorldTransform();
    const btQuaternion q = transform.getRotation();
    Eigen::Quaterniond turn(q.w(), q.x(), q.y(), q.z());
    turn.normalize();
    const btVector3& o = transform.getOrigin();
    const Vec3<double> at = body_.radius * Vec3<double>(o.x(), o.y(), o.z()) - turn * body_.centre;
    for (const double x : {at[0], at[1], at[2], turn.w(), turn.x(), turn.y(), turn.z()})
      data.push_back(x);
  }

  const Heap& heap_;
  Body body_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btStaticPlaneShape>> walls_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::size_t first_ = 0;  ///< of the bodies: those before are walls
};

void write(const Heap& heap) {
  if (heap.out.empty()) throw Unusable("--out: is needed");
  if (!(heap.side >= 2.1 && heap.side <= 1e3))
    throw Unusable("--side: must be from 2.1 to 1000 radii");
  if (heap.objects < 1 || heap.objects > 10000 || heap.frames > 1000000)
    throw Unusable("--objects, --frames: at most 10 000 and 1 000 000");
  const NamedMesh mesh = named_mesh(heap.mesh, heap.polygons);
  const Array<double> trace = Simulation(heap, mesh.mesh).run();
  write_npy<double>(heap.out, trace.shape, trace.data);
}

}  // namespace
}  // namespace bvlab

int main(int argc, char** argv) {
  CLI::App app("Meshes dropped into a pit, by Bullet's simulation of rigid bodies", "bvlab_heap");
  bvlab::Heap heap;
  app.add_option("--mesh", heap.mesh, "a mesh by name")->capture_default_str();
  app.add_option("--polygons", heap.polygons, "triangles of it")->capture_default_str();
  app.add_option("--objects", heap.objects, "number of bodies")->capture_default_str();
  app.add_option("--frames", heap.frames, "number of frames, the start included")
      ->capture_default_str();
  app.add_option("--side", heap.side, "side of the floor, in radii of the mesh")
      ->capture_default_str();
  app.add_option("--seed", heap.seed, "of the random orientations")->capture_default_str();
  app.add_option("--out", heap.out, "the trace, `.npy`");
  try {
    app.parse(argc, argv);
    bvlab::write(heap);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::Error& error) {
    std::fprintf(stderr, "bvlab_heap: %s\n", error.what());
    return 2;
  } catch (const bvlab::Unusable& fault) {
    std::fprintf(stderr, "bvlab_heap: %s\n", fault.what());
    return 2;
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "bvlab_heap: %s\n", fault.what());
    return 1;
  }
  return 0;
}
