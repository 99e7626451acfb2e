// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/pair_answers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "experiments/replay/any_bodies.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "hierarchies/geometry/scalar.hpp"
#include "traversal/bodies.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/queries/distance.hpp"
#include "traversal/rotated_mesh_box.hpp"

namespace bvlab {
namespace {

/// Bodies under one query, which are moved where they stand elsewhere than when they were asked.
template <class Query>
class AskedBodies {
 public:
  AskedBodies(const AnyHierarchies& hierarchies, std::string_view volume, std::size_t objects,
              Frame frame)
      : bodies_(bodies_entry<Query>(volume).bodies(hierarchies, objects, frame)), poses_(objects) {}

  std::size_t size() const { return poses_.size(); }
  void add(const OneOfHierarchies& of_mesh) {
    bodies_.add(of_mesh);
    poses_.emplace_back();
  }

  void ask(const ObjectPair& pair, std::span<const Pose> poses, Query& query) {
    // Volumes are posed relative to where bodies are: see centre_of.
    if (!origin_) origin_ = centre_of(poses, bodies_);
    for (const auto k : {pair.i, pair.j}) {
      if (poses_[k] == poses[k]) continue;
      bodies_.move(k, poses[k], *origin_);
      poses_[k] = poses[k];
    }
    NotCounting counter;
    bodies_.pair(pair, query, counter).from_roots();
  }

 private:
  AnyBodies<Query> bodies_;
  std::vector<std::optional<Pose>> poses_;
  std::optional<Vec3<double>> origin_;
};

/// Farther out by at least `reach`, or everywhere.
Box<float> larger(Box<float> box, double reach) {
  constexpr float most = std::numeric_limits<float>::max();
  for (int axis = 0; axis < 3; ++axis) {
    // One rounding of the difference, which the step to the next float makes good.
    box.lo[axis] =
        std::max(rounded_down<float>(std::nextafter(box.lo[axis] - reach, -HUGE_VAL)), -most);
    box.hi[axis] =
        std::min(rounded_up<float>(std::nextafter(box.hi[axis] + reach, HUGE_VAL)), most);
  }
  return box;
}

/// A variant whose loops are found by the volume's name: the answers are the same whatever is
/// asked.
Variant gathered(Variant variant) {
  if (variant.kernel == "gathered") return variant;
  set_tree(variant, "binary");
  variant.leaf_size = 1;
  variant.volume = name_or_first("obb", volumes());
  return variant;
}

}  // namespace

struct PairAnswers::Engine {
  Engine(std::span<const TriangleMesh> meshes, std::size_t objects, const Variant& variant)
      : meshes(meshes), objects(objects), variant(gathered(variant)) {}

  const TriangleMesh& mesh(std::size_t object) const {
    return object < objects ? meshes[object % meshes.size()] : *added[object - objects];
  }

  template <class Query>
  AskedBodies<Query>& of(std::optional<AskedBodies<Query>>& bodies) {
    if (!hierarchies) {
      const VolumeEntry& volume = volume_entry(variant.volume);
      hierarchies.emplace(volume, volume.hierarchies(meshes, variant), variant);
    }
    if (!bodies) bodies.emplace(hierarchies->first(), variant.volume, objects, frame_of(variant));
    while (bodies->size() < objects + added.size())
      bodies->add(hierarchies->of(mesh(bodies->size())));
    return *bodies;
  }

  std::span<const TriangleMesh> meshes;
  std::size_t objects;
  std::vector<const TriangleMesh*> added;  // the meshes of objects that came later
  Variant variant;
  std::optional<HierarchiesByMesh> hierarchies;
  std::optional<AskedBodies<Contacts>> for_contacts;
  std::optional<AskedBodies<Distance>> for_distances;
  // The boxes of meshes, each once, and which of them each object has.
  std::vector<RotatedMeshBox> boxes;
  std::unordered_map<const TriangleMesh*, std::size_t> known_boxes;
  std::vector<std::size_t> box_of;
  const std::unique_ptr<AnyMethod<float>> method =
      make_method<float>("auto", {.coherence = Coherence::off});
};

PairAnswers::PairAnswers(std::span<const TriangleMesh> meshes, std::size_t objects,
                         const Variant& variant)
    : engine_(std::make_unique<Engine>(meshes, objects, variant)) {}
PairAnswers::~PairAnswers() = default;

void PairAnswers::add(const TriangleMesh& mesh) { engine_->added.push_back(&mesh); }
std::size_t PairAnswers::size() const { return engine_->objects + engine_->added.size(); }

std::vector<ObjectPair> PairAnswers::near(std::span<const Pose> poses,
                                          std::span<const std::uint8_t> present, double distance) {
  while (engine_->box_of.size() < size()) {
    const TriangleMesh& mesh = engine_->mesh(engine_->box_of.size());
    const auto [at, fresh] = engine_->known_boxes.try_emplace(&mesh, engine_->boxes.size());
    if (fresh) engine_->boxes.emplace_back(mesh);
    engine_->box_of.push_back(at->second);
  }
  std::vector<Box<float>> boxes;
  std::vector<std::uint32_t> objects;  // whose each is
  Vec3<double> origin = Vec3<double>::Zero();
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (!present[i]) continue;
    const RotatedMeshBox& of_mesh = engine_->boxes[engine_->box_of[i]];
    // Relative to the first body: what boxes lose by being float makes them larger.
    if (boxes.empty()) origin = of_mesh.mesh_origin(poses[i]);
    // Half of the largest number and more are too large for floats.
    const double reach = std::min(distance, std::numeric_limits<double>::max()) / 2;
    boxes.push_back(larger(of_mesh(poses[i], origin), reach));
    objects.push_back(i);
  }
  std::vector<ObjectPair> found;
  for (const Pair& pair : engine_->method->overlapping(boxes))
    found.push_back({objects[pair.i], objects[pair.j]});
  std::sort(found.begin(), found.end(), before);
  return found;
}

std::vector<std::array<std::uint32_t, 4>> PairAnswers::contacts(std::span<const ObjectPair> pairs,
                                                                std::span<const Pose> poses) {
  auto& bodies = engine_->of(engine_->for_contacts);
  const TriangleTest test = triangle_test(engine_->variant.precision);
  std::vector<std::array<std::uint32_t, 4>> rows;
  std::vector<Contact> found;
  for (const ObjectPair& pair : pairs) {
    found.clear();
    Contacts query(found, test);
    bodies.ask(pair, poses, query);
    std::sort(found.begin(), found.end());
    for (const auto& [a, b] : found) rows.push_back({pair.i, pair.j, a, b});
  }
  return rows;
}

std::vector<NearestTriangles> PairAnswers::distances(std::span<const ObjectPair> pairs,
                                                     std::span<const Pose> poses) {
  auto& bodies = engine_->of(engine_->for_distances);
  std::vector<NearestTriangles> all;
  for (const ObjectPair& pair : pairs) {
    Distance query(engine_->variant.relative_error);
    bodies.ask(pair, poses, query);
    all.push_back(query.nearest());
  }
  return all;
}

}  // namespace bvlab
