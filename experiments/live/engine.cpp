// SPDX-License-Identifier: BSD-3-Clause
/// The engine as a page calls it: functions over numbers and addresses in the module's own memory,
/// called by engine.js. Bodies use meshes in turn, as in a trace; each run plays the same poses with
/// a variant of its own. What is returned is valid until the next call.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <functional>
#include <numeric>
#include <queue>
#include <typeinfo>

#include "experiments/live/players.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/replay/topology_of.hpp"
#include "experiments/replay/volume_of.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/primitives/triangle_distance.hpp"
#include "traversal/queries.hpp"

// What players call of the program's: a page asks about all pairs and counts, which a broad phase
// is never used for.
namespace bvlab {
std::vector<ObjectPair> object_pairs(const Trace& trace) {
  return all_object_pairs(static_cast<std::uint32_t>(trace.objects));
}
bool detail::broad_phase_pays(const Trace&, const ReplayOptions&) { return false; }
template <>
std::unique_ptr<AnyMethod<float>> make_method(std::string_view, const MethodSettings&) {
  return nullptr;
}
}  // namespace bvlab

namespace bvlab::live {
namespace {

std::vector<TriangleMesh> meshes;
/// Two frames in turn: who stands as in the frame before is not posed again.
Trace trace{2, 0, {}};
std::size_t turn = 0;
std::vector<std::unique_ptr<Run>> runs;

/// Calls `with` with the volume's type.
template <class With>
bool with_volume(std::string_view name, const With& with) {
  return Volumes::with(name, with) || WideVolumes::with(name, with);
}

std::unique_ptr<Run> made(std::string_view volume, std::string_view strategy,
                          std::string_view query, std::string_view kernel, std::uint32_t fan_out) {
  auto run = std::make_unique<Run>();
  Variant& variant = run->variant;
  variant.volume = volume, variant.strategy = strategy, variant.query = query;
  variant.kernel = kernel, variant.fan_out = fan_out;
  if (kernel != "gathered")
    variant.frame = name_of(Frame::body),
    variant.fan_out = kernel == MixedKernel::name ? 4 : native_fan_out<float>;
  run->options.count = Count::on;
  if (!with_volume(volume, [&]<class V>(std::type_identity<V>) {
        run->hierarchies = std::make_unique<HierarchiesOf<V>>(meshes, variant);
      }))
    return nullptr;
  Queries::with(query, [&]<class Query>(std::type_identity<Query>) {
    run->player = player<Query>(meshes, trace, *run);
  });
  return run->player ? std::move(run) : nullptr;
}

/// An array, as engine.js reads it: where it is, and how many entries of it there are.
struct Array {
  const void* begin;
  std::size_t size;
} array;
template <class T>
const Array* told(const T& values) {
  array = {values.data(), values.size()};
  return &array;
}

}  // namespace
}  // namespace bvlab::live

using namespace bvlab;
using namespace bvlab::live;

#define BVLAB_EXPORT(name) extern "C" [[clang::export_name(#name)]]

BVLAB_EXPORT(room) void* room(std::size_t bytes) { return std::malloc(bytes); }
BVLAB_EXPORT(lanes) int lanes() { return native_width<float>; }

/// Adds a mesh, from three numbers a vertex and three a triangle; both are freed.
BVLAB_EXPORT(add_mesh)
void add_mesh(double* vertices, std::size_t vertex_count, std::uint32_t* triangles,
              std::size_t triangle_count) {
  TriangleMesh& mesh = meshes.emplace_back();
  for (std::size_t i = 0; i < vertex_count; ++i)
    mesh.vertices.push_back({vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]});
  for (std::size_t i = 0; i < triangle_count; ++i)
    mesh.triangles.push_back({triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
  std::free(vertices), std::free(triangles);
}

/// After all meshes: how many bodies there are.
BVLAB_EXPORT(set_bodies) void set_bodies(std::size_t bodies) {
  trace.objects = bodies;
  trace.values.assign(2 * bodies * 7, 0);
}
/// Where the next frame's poses are to be put: x y z qw qx qy qz for each body.
BVLAB_EXPORT(next_poses) double* next_poses() {
  turn = 1 - turn;
  return trace.values.data() + turn * trace.objects * 7;
}

/// Of a text "volume strategy query kernel", words ended by zeros; -1 where there is none. Poses must
/// have been put. The run's number.
BVLAB_EXPORT(add_run) int add_run(const char* words, std::uint32_t fan_out) {
  std::array<std::string_view, 4> word;
  for (auto& each : word) each = words, words += each.size() + 1;
  auto run = made(word[0], word[1], word[2], word[3], fan_out);
  if (!run) return -1;
  runs.push_back(std::move(run));
  return static_cast<int>(runs.size()) - 1;
}
BVLAB_EXPORT(end_run) void end_run(std::size_t run) { runs[run].reset(); }

/// Plays the next frame.
BVLAB_EXPORT(play) void play(std::size_t run) {
  Run& now = *runs[run];
  ReplayResult& all = now.result;
  all.contacts.clear(), now.front.clear(), now.tested.clear();
  all.n_b = all.n_u = all.n_v = all.n_p = all.hits = 0, all.front = 0;
  now.player->play(turn);
  // The player counts on and on: it adds the sums over all frames so far.
  now.player->finish();
  const decltype(now.sums) sums{all.n_u, all.n_v, all.n_p, 0, all.hits, all.n_b};
  std::transform(sums.begin(), sums.end(), now.sums.begin(), now.counts.begin(), std::minus<>());
  now.counts[3] = all.front, now.sums = sums;
}

/// After `play`: N_u, N_v, N_p, entries of all fronts, hits, N_b.
BVLAB_EXPORT(counts) const Array* counts(std::size_t run) { return told(runs[run]->counts); }
/// After `play`, by what was asked: one byte a pair, one double a pair, or five numbers a contact.
BVLAB_EXPORT(touching) const Array* touching(std::size_t run) {
  const auto& all = runs[run]->result.touching;
  return told(std::span(all).subspan(turn * all.size() / 2, all.size() / 2));
}
BVLAB_EXPORT(distances) const Array* distances(std::size_t run) {
  const auto& all = runs[run]->result.distances;
  return told(std::span(all).subspan(turn * all.size() / 2, all.size() / 2));
}
BVLAB_EXPORT(contacts) const Array* contacts(std::size_t run) {
  auto& all = runs[run]->result.contacts;
  std::sort(all.begin(), all.end());
  array = {all.data(), 5 * all.size()};
  return &array;
}

/// From now on what the pair of that number keeps can be asked for; of none where there is none.
BVLAB_EXPORT(watch) void watch(std::size_t run, std::size_t pair) {
  Run& now = *runs[run];
  now.watched = pair, now.front.clear(), now.tested.clear();
  now.options.see_front = nullptr;
  if (pair < trace.pairs())
    now.options.see_front = [&now](std::size_t, std::size_t p, std::span<const NodePair> entries) {
      if (p == now.watched) now.front.assign(entries.begin(), entries.end());
    };
}
/// After `play`: of each entry of the watched pair's front its two nodes, and 1 where this frame
/// has tested it.
BVLAB_EXPORT(front) const Array* front(std::size_t run) {
  static std::vector<std::uint32_t> all;
  Run& now = *runs[run];
  const auto order = [](const NodePair& x, const NodePair& y) {
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  };
  std::sort(now.tested.begin(), now.tested.end(), order);
  all.clear();
  for (const NodePair& entry : now.front)
    all.insert(all.end(), {entry.a, entry.b,
                           std::uint32_t{std::binary_search(now.tested.begin(), now.tested.end(),
                                                            entry, order)}});
  return told(all);
}

/// Nearest points of two bodies, by a search of its own over spheres, nearest first: queries keep
/// only how far they are apart.
BVLAB_EXPORT(nearest) const Array* nearest(std::size_t i, std::size_t j) {
  static std::vector<Hierarchy<Sphere<float>>> trees;
  static std::array<double, 6> points;
  for (std::size_t m = trees.size(); m < meshes.size(); ++m)
    trees.emplace_back(meshes[m], topology_of(meshes[m], Variant{}));
  const std::size_t body[] = {i, j};
  std::vector<Pose> poses(trace.objects);
  trace.poses(turn, poses);
  const auto gap = [&](const NodePair& nodes) {
    Vec3<double> centre[2];
    double radii = 0;
    for (int side = 0; side < 2; ++side) {
      const auto& tree = trees[body[side] % trees.size()];
      const auto& sphere = tree.volume(side ? nodes.b : nodes.a);
      centre[side] = poses[body[side]](Vec3<double>(sphere.centre.cast<double>()));
      radii += sphere.radius;
    }
    return (centre[0] - centre[1]).norm() - radii;
  };
  using Open = std::pair<double, NodePair>;
  const auto later = [](const Open& x, const Open& y) { return x.first > y.first; };
  std::priority_queue<Open, std::vector<Open>, decltype(later)> open(later);
  const auto push = [&](const NodePair& nodes) { open.push({gap(nodes), nodes}); };
  push({0, 0});
  for (double least = std::numeric_limits<double>::infinity(); !open.empty();) {
    const auto [bound, nodes] = open.top();
    open.pop();
    if (bound > least) break;
    const std::size_t m = i % meshes.size(), n = j % meshes.size();
    const auto &a = trees[m], &b = trees[n];
    const auto &at = a.node(nodes.a), &bt = b.node(nodes.b);
    if (at.count && bt.count) {
      for (std::uint32_t s = at.first; s < at.first + at.count; ++s)
        for (std::uint32_t t = bt.first; t < bt.first + bt.count; ++t) {
          const auto found =
              bvlab::distance<double>(poses[i](meshes[m].corners(a.primitive(s))),
                                      poses[j](meshes[n].corners(b.primitive(t))));
          if (!(found.distance < least)) continue;
          least = found.distance;
          for (int k = 0; k < 3; ++k) points[k] = found.on_a[k], points[3 + k] = found.on_b[k];
        }
    } else if (bt.count || (!at.count && at.size >= bt.size)) {
      for (std::uint32_t k = 0; k < at.children; ++k) push({at.first + k, nodes.b});
    } else {
      for (std::uint32_t k = 0; k < bt.children; ++k) push({nodes.a, bt.first + k});
    }
  }
  return told(points);
}

/// Of each node of a mesh's tree the first of its children, and how many there are.
BVLAB_EXPORT(children) const Array* children(std::size_t run, std::size_t mesh) {
  static std::vector<std::uint32_t> all;
  all.clear();
  const Variant& variant = runs[run]->variant;
  if (variant.fan_out == 2)
    for (const auto& node : topology_of(meshes[mesh], variant).nodes)
      all.insert(all.end(), {node.first, node.count == 0 ? 2u : 0u});
  else
    for (const auto& node : wide_topology_of(meshes[mesh], variant).nodes)
      all.insert(all.end(), {node.first, node.leaf ? 0 : node.count});
  return told(all);
}
/// The volumes of all nodes, in numbers for who draws them (drawn_volume.hpp); and what they are.
BVLAB_EXPORT(volumes) const Array* volumes(std::size_t run, std::size_t mesh) {
  static std::vector<float> all;
  std::vector<std::uint32_t> nodes(children(run, mesh)->size / 2);
  std::iota(nodes.begin(), nodes.end(), 0u);
  with_volume(runs[run]->variant.volume, [&]<class V>(std::type_identity<V>) {
    all = detail::drawn_of<V>(*runs[run]->hierarchies, mesh, nodes);
  });
  return told(all);
}
BVLAB_EXPORT(drawn_as) const Array* drawn_as(std::size_t run) {
  static std::string_view what;
  with_volume(runs[run]->variant.volume,
              [&]<class V>(std::type_identity<V>) { what = bvlab::drawn_as<V>(); });
  return told(what);
}

// Exceptions end the module: what they say goes to the page. Nothing here catches any.
extern "C" [[clang::import_module("bvlab"), clang::import_name("fail")]] void fail(const char*);
extern "C" void* __cxa_allocate_exception(std::size_t size) { return std::malloc(size); }
extern "C" [[noreturn]] void __cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {
  ::fail(static_cast<std::exception*>(thrown)->what());
  __builtin_trap();
}
