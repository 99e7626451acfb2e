// SPDX-License-Identifier: BSD-3-Clause
/// Answers and counts, to compare compilers and processors (experiments/matrix): one line for each
/// volume, strategy and query, one for a world, one for boxes; verdicts and pairs as hashes. Meshes
/// and motions are made of small whole numbers, so that they are the same everywhere; so are
/// batches, eight lanes wide.
#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "broadphase/methods/auto.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/kdop.hpp"
#include "hierarchies/volumes/obb.hpp"
#include "hierarchies/volumes/sphere.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/recursive.hpp"
#include "traversal/strategies/separation_list.hpp"
#include "traversal/world.hpp"

namespace {

using namespace bvlab;
constexpr int frames = 60, bodies = 4;

class Hash {
 public:
  void add(std::uint64_t x) { state_ = (state_ ^ x) * 0x100000001b3; }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

/// Whole numbers from 0 to below 2^31.
class Draw {
 public:
  std::uint32_t operator()(std::uint32_t below) {
    state_ = state_ * 6364136223846793005 + 1442695040888963407;
    return static_cast<std::uint32_t>(state_ >> 33) % below;
  }

 private:
  std::uint64_t state_ = 1;
};

/// A bumpy sheet of 2 x 16 x 16 triangles, folded along its middle.
TriangleMesh sheet() {
  Draw draw;
  TriangleMesh mesh;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j)
      mesh.vertices.push_back({i / 8.0, j / 8.0, std::abs(i - 8) / 16.0 + draw(64) / 1024.0});
  for (std::uint32_t i = 0; i < 16; ++i)
    for (std::uint32_t j = 0; j < 16; ++j) {
      const std::uint32_t at = 17 * i + j;
      mesh.triangles.push_back({at, at + 1, at + 17});
      mesh.triangles.push_back({at + 18, at + 17, at + 1});
    }
  return mesh;
}

std::vector<Pose> poses_at(int frame) {
  std::vector<Pose> poses;
  for (int i = 0; i < bodies; ++i)
    poses.push_back(*pose_from({i * (40 - frame % 31) / 32.0, i % 2 * frame / 256.0, i / 16.0}, 8,
                               i * frame / 32.0, (i + 1) / 4.0, -frame / 64.0 * i));
  return poses;
}

void put(const char* volume, std::string_view strategy, const char* query, const char* answers,
         const Counting& counts) {
  std::printf("%s %.*s %s %s N_u %" PRIu64 " N_v %" PRIu64 " N_p %" PRIu64 "\n", volume,
              static_cast<int>(strategy.size()), strategy.data(), query, answers, counts.n_u,
              counts.n_v, counts.n_p);
}

void put(const char* volume, std::string_view strategy, const char* query, const Hash& hash,
         const Counting& counts) {
  char text[32];
  std::snprintf(text, sizeof text, "%016" PRIx64, hash.value());
  put(volume, strategy, query, text, counts);
}

/// Distances are exact but for some of their last bits, which are a processor's (Eigen fuses
/// products where it can): their sum to ten digits.
void put(const char* volume, std::string_view strategy, const char* query, double sum,
         const Counting& counts) {
  char text[32];
  std::snprintf(text, sizeof text, "%.8f", sum);
  put(volume, strategy, query, text, counts);
}

template <class V, class Strategy>
void ask(const char* volume, const TriangleMesh& mesh, const Hierarchy<V>& hierarchy) {
  const std::vector<Shape<V>> shapes(bodies, {&mesh, &hierarchy});
  const auto pairs = [&] {
    return AllPairs<Batch<float, 8>, V, Strategy>(shapes, all_object_pairs(bodies), Strategy{});
  };
  Hash hash[2];
  double sum = 0;
  Counting counts[3];
  auto touching = pairs(), contacts = pairs(), distance = pairs();
  for (int frame = 0; frame < frames; ++frame) {
    const auto poses = poses_at(frame);
    touching.frame(
        poses, counts[0], [](std::size_t) { return Touching(); },
        [&](std::size_t, const Touching& query) { hash[0].add(std::uint64_t{query.touching()}); });
    std::vector<Contact> found;
    contacts.frame(
        poses, counts[1], [&](std::size_t) { return Contacts(found); },
        [](std::size_t, const Contacts&) {});
    std::sort(found.begin(), found.end());
    for (const Contact& contact : found) hash[1].add(std::uint64_t{contact[0]} << 32 | contact[1]);
    distance.frame(
        poses, counts[2], [](std::size_t) { return Distance(); },
        [&](std::size_t, const Distance& query) { sum += query.distance(); });
  }
  put(volume, Strategy::name, "touching", hash[0], counts[0]);
  put(volume, Strategy::name, "contacts", hash[1], counts[1]);
  put(volume, Strategy::name, "distance", sum, counts[2]);
}

template <class V>
void ask_all(const char* volume, const TriangleMesh& mesh) {
  const Hierarchy<V> hierarchy(mesh, builds::BottomUpLocal::topology(mesh, 1));
  ask<V, Recursive>(volume, mesh, hierarchy);
  ask<V, Deferred>(volume, mesh, hierarchy);
  ask<V, Margins>(volume, mesh, hierarchy);
}

/// The fan-out follows the registers: its answers are the same, its counts are not.
void ask_world(const TriangleMesh& mesh) {
  const auto tree = Recommended::hierarchy(mesh);
  const std::vector<Recommended::Shape> shapes(bodies, {&mesh, &tree});
  World world(shapes);
  TouchingPairs touching;
  NotCounting counter;
  Hash hash;
  for (int frame = 0; frame < frames; ++frame) {
    const auto poses = poses_at(frame);
    for (std::uint32_t i = 0; i < bodies; ++i) world.move(i, poses[i]);
    world.update(
        counter, [](const ObjectPair&) { return Touching(); },
        [&](std::uint32_t slot, const ObjectPair& pair, const Touching& query) {
          touching.put(slot, pair, query.touching());
        },
        [&](std::uint32_t slot) { touching.drop(slot); });
    std::vector<std::uint64_t> pairs;
    for (const auto& [i, j] : touching.pairs()) pairs.push_back(std::uint64_t{i} << 32 | j);
    std::sort(pairs.begin(), pairs.end());
    for (const auto pair : pairs) hash.add(pair);
  }
  std::printf("world touching %016" PRIx64 "\n", hash.value());
}

void ask_boxes() {
  Draw draw;
  std::vector<Box<float>> boxes(3000);
  Auto<float, Closed> method{MethodSettings{}};
  Hash hash;
  for (int frame = 0; frame < 10; ++frame) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      if (frame == 0 || i % 3 == 0)
        for (int k = 0; k < 3; ++k)
          boxes[i].hi[k] =
              (boxes[i].lo[k] = static_cast<float>(draw(512))) + static_cast<float>(draw(64));
    std::vector<std::uint64_t> pairs;
    for (const auto& [i, j] : method.overlapping(boxes))
      pairs.push_back(std::uint64_t{std::min(i, j)} << 32 | std::max(i, j));
    std::sort(pairs.begin(), pairs.end());
    for (const auto pair : pairs) hash.add(pair);
  }
  std::printf("boxes auto %016" PRIx64 "\n", hash.value());
}

}  // namespace

int main() {
  const TriangleMesh mesh = sheet();
  ask_all<Sphere<float>>("sphere", mesh);
  ask_all<Obb<float>>("obb", mesh);
  ask_all<Kdop18<float>>("kdop18", mesh);
  ask_world(mesh);
  ask_boxes();
}
