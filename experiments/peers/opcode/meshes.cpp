// SPDX-License-Identifier: BSD-3-Clause
/// OPCODE's mesh against mesh, called directly: trees without leaves, not quantised, all 15 axes,
/// first contact, which is what its manual calls fastest. All arithmetic is float32, also of the
/// poses, which are taken relative to the first body of the first frame.
#include <Opcode.h>

#include <memory>

#include "experiments/peers/play_peer.hpp"
#include "traversal/counters.hpp"

namespace bvlab {
namespace {

/// A mesh in OPCODE's types, with its tree.
class OpcodeMesh {
 public:
  explicit OpcodeMesh(const TriangleMesh& mesh) {
    for (const auto& v : mesh.vertices)
      vertices_.emplace_back(static_cast<float>(v[0]), static_cast<float>(v[1]),
                             static_cast<float>(v[2]));
    for (const auto& [a, b, c] : mesh.triangles)
      triangles_.emplace_back(static_cast<dTriIndex>(a), static_cast<dTriIndex>(b),
                              static_cast<dTriIndex>(c));
    interface_.SetNbTriangles(static_cast<udword>(triangles_.size()));
    interface_.SetNbVertices(static_cast<udword>(vertices_.size()));
    interface_.SetPointers(triangles_.data(), vertices_.data());
    interface_.SetSingle(true);
    Opcode::OPCODECREATE create;
    create.mIMesh = &interface_;
    create.mNoLeaf = true;
    create.mQuantized = false;
    model_.Build(create);
  }
  OpcodeMesh(const OpcodeMesh&) = delete;
  OpcodeMesh& operator=(const OpcodeMesh&) = delete;

  const Opcode::Model& model() const { return model_; }

 private:
  std::vector<Point> vertices_;
  std::vector<IndexedTriangle> triangles_;
  Opcode::MeshInterface interface_;
  Opcode::Model model_;
};

/// Whether the pair of triangles that met last is tried first.
enum class OpcodeCoherence { off, on };

template <OpcodeCoherence coherence, class Counter>
class OpcodeWorld {
 public:
  OpcodeWorld(std::span<const TriangleMesh> meshes, std::size_t objects)
      : poses_(objects), caches_(objects * objects) {
    for (const auto& mesh : meshes) meshes_.push_back(std::make_unique<OpcodeMesh>(mesh));
    for (std::size_t i = 0; i < objects; ++i)
      for (std::size_t j = 0; j < objects; ++j) {
        auto& cache = caches_[i * objects + j];
        cache.Model0 = &meshes_[i % meshes_.size()]->model();
        cache.Model1 = &meshes_[j % meshes_.size()]->model();
        cache.id0 = cache.id1 = 0;
      }
    first_contact_.SetFirstContact(true);
    first_contact_.SetTemporalCoherence(coherence == OpcodeCoherence::on);
    all_contacts_.SetFirstContact(false);
    all_contacts_.SetTemporalCoherence(false);
  }

  /// Its matrices are of rows: a point is a row, too.
  void place(std::size_t i, const Pose& pose) {
    if (!placed_) origin_ = pose.translation, placed_ = true;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        poses_[i].m[column][row] = static_cast<float>(pose.rotation(row, column));
      poses_[i].m[3][row] = static_cast<float>(pose.translation[row] - origin_[row]);
      poses_[i].m[row][3] = 0;
    }
    poses_[i].m[3][3] = 1;
  }

  bool touching(std::size_t i, std::size_t j) { return collide(first_contact_, i, j); }

  void contacts(std::size_t i, std::size_t j, std::vector<Contact>& found) {
    collide(all_contacts_, i, j);
    const auto* pairs = all_contacts_.GetPairs();
    for (udword k = 0; k < all_contacts_.GetNbPairs(); ++k)
      found.push_back({pairs[k].id0, pairs[k].id1});
  }

  const Counter& counter() const { return counter_; }

 private:
  bool collide(Opcode::AABBTreeCollider& collider, std::size_t i, std::size_t j) {
    collider.Collide(caches_[i * poses_.size() + j], &poses_[i], &poses_[j]);
    if constexpr (Counter::counts) {
      counter_.tested(collider.GetNbBVBVTests() + collider.GetNbBVPrimTests());
      counter_.primitives(collider.GetNbPrimPrimTests());
    }
    return collider.GetContactStatus();
  }

  std::vector<std::unique_ptr<OpcodeMesh>> meshes_;
  std::vector<Matrix4x4> poses_;
  std::vector<Opcode::BVTCache> caches_;
  Opcode::AABBTreeCollider first_contact_, all_contacts_;
  Vec3<double> origin_ = Vec3<double>::Zero();
  bool placed_ = false;
  Counter counter_;
};

template <OpcodeCoherence coherence>
ReplayResult replay_opcode(std::span<const TriangleMesh> meshes, const Trace& trace,
                           std::string_view query, const ReplayOptions& options) {
  static const bool ready = Opcode::InitOpcode();
  (void)ready;
  return play_counting_peer<OpcodeWorld<coherence, Counting>, OpcodeWorld<coherence, NotCounting>>(
      meshes, trace, query, options);
}

}  // namespace

std::span<const Peer> opcode_peers() {
  static constexpr Peer list[] = {
      {"opcode", "OPCODE 1.3, called directly, float32: no-leaf trees, boxes as they lie",
       "touching contacts", replay_opcode<OpcodeCoherence::off>},
      {"opcode-coherent", "the same; the pair of triangles that met last is tried first",
       "touching", replay_opcode<OpcodeCoherence::on>},
  };
  return list;
}

}  // namespace bvlab
