// SPDX-License-Identifier: BSD-3-Clause
/// How K-DOPs are posed: what a policy costs for each volume, what it saves in volumes, tests and
/// time, and how many pairs the roots alone dismiss. Bodies wander closer together or farther
/// apart (`sides`, in radii); every policy answers the same traces by recursion.
///
/// Rows with the query "roots" are about the roots alone: pose_ns is then for a body's root, all
/// that its pose needs included, and a policy "hull" is beside the others: supports of the
/// mesh's convex hull, found by climbing. Elsewhere pose_ns is C_u, averaged over all volumes of
/// the hierarchy, timed apart (those near the root have more corners than the rest).
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <random>

#include "experiments/closest_features/climbing_root.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/loops_of.hpp"
#include "experiments/replay/play.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/wandering.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes/kdop_corners.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/strategies/recursive.hpp"

namespace bvlab {
namespace {

StudyParameters parameters() {
  return with_wandering({numbers_parameter("sides", {1, 4, 8}, sides_of_cubes,
                                           "of the cubes, in radii of the body")});
}

using Scene = Wandering::Scene;

/// What is measured of a row.
struct Measured {
  double pose_ns = 0;
  std::size_t dismissed = 0;  ///< at the roots
  ReplayResult replay;
};

/// One policy under one query.
struct Cell {
  int k;
  std::string policy, query;
  std::function<Measured(Count)> measure;
  ReplayResult counted;
};

/// Nanoseconds for each of the `things` items that `work` handles; the least of a few runs.
double nanoseconds_each(std::size_t things, const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 5; ++round) {
    const auto start = Clock::now();
    work();
    least = std::min(least, seconds_since(start));
  }
  return least * 1e9 / static_cast<double>(things);
}

template <class V>
double cost_of_posing(const Scene& scene, const Hierarchy<V>& hierarchy) {
  Body<V> body(scene.meshes[0], hierarchy);
  std::vector<Pose> poses(scene.trace.objects);
  scene.trace.poses(0, poses);
  NotCounting counter;
  return nanoseconds_each(poses.size() * hierarchy.size(), [&] {
    for (const auto& pose : poses) {
      body.move(pose, Vec3<double>::Zero());
      for (std::uint32_t node = 0; node < hierarchy.size(); ++node) body.require(node, counter);
    }
  });
}

template <class V>
constexpr bool is_listed = false;
template <int K>
constexpr bool is_listed<Kdop<float, K, Realigned>> = true;

/// What was compiled for a volume of the list already makes its hierarchies and replays it.
template <class V, class Query>
ReplayResult replayed(const Scene& scene, Count count) {
  Variant variant;
  variant.volume = V::name;
  variant.query = Query::name;
  ReplayOptions options;
  options.count = count;
  return replay(scene.meshes, scene.trace, variant, options);
}

/// Bounds the roots of all bodies in all frames by `pose_root(body, pose, origin)`.
template <class PoseRoot>
Measured at_roots(const Trace& trace, const PoseRoot& pose_root) {
  using Bounds = std::invoke_result_t<PoseRoot, std::size_t, const Pose&, const Vec3<double>&>;
  std::vector<Pose> poses(trace.objects);
  std::vector<Bounds> roots(trace.objects * trace.frames);
  trace.poses(0, poses);
  struct AboutZero {  // the meshes
    static Vec3<double> mesh_origin(std::size_t) { return Vec3<double>::Zero(); }
  };
  const Vec3<double> origin = centre_of(poses, AboutZero());
  Measured measured;
  measured.pose_ns = nanoseconds_each(roots.size(), [&] {
    for (std::size_t frame = 0; frame < trace.frames; ++frame) {
      trace.poses(frame, poses);
      for (std::size_t i = 0; i < poses.size(); ++i)
        roots[frame * poses.size() + i] = pose_root(i, poses[i], origin);
    }
  });
  for (std::size_t frame = 0; frame < trace.frames; ++frame)
    for (const auto& [i, j] : all_object_pairs(static_cast<std::uint32_t>(trace.objects)))
      measured.dismissed +=
          disjoint(roots[frame * trace.objects + i], roots[frame * trace.objects + j]);
  return measured;
}

/// Again and again for a tenth of a second: some scenes take a millisecond, which one interruption
/// doubles.
ReplayResult fastest_of(const std::function<ReplayResult()>& play) {
  const auto start = Clock::now();
  ReplayResult fastest = play();
  while (seconds_since(start) < 0.1)
    if (auto again = play(); again.seconds < fastest.seconds) fastest = std::move(again);
  return fastest;
}

/// In place of hierarchies by mesh: no body is added.
struct NothingIsAdded {
  static OneOfHierarchies of(const TriangleMesh&) { std::abort(); }
};

/// Recursion over bodies whose volume is not in the list, started as over one that is.
template <class Query>
ReplayResult recursed(const Scene& scene, std::unique_ptr<BodyLoops<Query>> loops, Count count) {
  ReplayOptions options;
  options.count = count;
  ReplayResult result;
  using Bodies = AnyBodies<Query, Counting, TypeList<NoFront>>;
  using Pairs = StrategyPairs<Bodies, Recursive>;
  detail::play_pairs<Query>(std::make_unique<detail::PairsOver<Pairs, Query, NothingIsAdded>>(
                                NothingIsAdded(), Pairs(Bodies(std::move(loops)), Recursive())),
                            scene.meshes, scene.trace, Variant{}, options, result);
  return result;
}

template <class V, class Query>
ReplayResult engine_of_its_own(const Scene& scene, const Hierarchy<V>& hierarchy, Count count) {
  const std::vector<Shape<V>> shapes(scene.trace.objects, {&scene.meshes[0], &hierarchy});
  using Loops = detail::LoopsOver<V, Query, TypeList<NoFront>>;
  return recursed<Query>(scene, std::make_unique<Loops>(shapes, Frame::world), count);
}

template <class V, class Query>
ReplayResult played(const Scene& scene, const Hierarchy<V>& hierarchy, Count count) {
  if constexpr (is_listed<V>)
    return replayed<V, Query>(scene, count);
  else
    return engine_of_its_own<V, Query>(scene, hierarchy, count);
}

template <class V, class Query>
Cell asking(int k, std::string policy, const Scene& scene,
            std::shared_ptr<const Hierarchy<V>> hierarchy) {
  return {k,
          std::move(policy),
          std::string(Query::name),
          [&scene, hierarchy](Count count) {
            Measured measured;
            if (count == Count::on) {
              measured.replay = played<V, Query>(scene, *hierarchy, count);
            } else {
              measured.pose_ns = cost_of_posing(scene, *hierarchy);
              measured.replay =
                  fastest_of([&] { return played<V, Query>(scene, *hierarchy, count); });
            }
            return measured;
          },
          {}};
}

template <class V>
std::shared_ptr<const Hierarchy<V>> hierarchy_over(const Scene& scene) {
  if constexpr (is_listed<V>) {
    const std::shared_ptr<AnyHierarchies> all =
        volume_entry(V::name).hierarchies(scene.meshes, Variant{});
    return {all, &static_cast<const HierarchiesOf<V>&>(*all)[0]};
  } else {
    const auto& mesh = scene.meshes[0];
    return std::make_shared<Hierarchy<V>>(mesh, builds::TopDownPrincipal::topology(mesh, 1));
  }
}

template <int K, class Posing>
void add_policy(const std::string& policy, const Scene& scene, std::vector<Cell>& cells) {
  using V = Kdop<float, K, Posing>;
  const auto hierarchy = hierarchy_over<V>(scene);
  cells.push_back(asking<V, Touching>(K, policy, scene, hierarchy));
  cells.push_back(asking<V, Contacts>(K, policy, scene, hierarchy));
  cells.push_back({K,
                   policy,
                   "roots",
                   [&scene, hierarchy](Count) {
                     return at_roots(scene.trace, [&](std::size_t, const Pose& pose,
                                                      const Vec3<double>& origin) {
                       return posed(hierarchy->volume(0),
                                    world_placement<V>(pose, origin, hierarchy->extent()));
                     });
                   },
                   {}});
}

template <int K>
void add_policies(const Scene& scene, const closest_features::Polytope& hull,
                  std::vector<Cell>& cells) {
  add_policy<K, Realigned>("realigned", scene, cells);
  add_policy<K, ByCorners>("corners", scene, cells);
  double reach = 0;
  for (const auto& v : scene.meshes[0].vertices) reach = std::max(reach, v.norm());
  cells.push_back({K,
                   "hull",
                   "roots",
                   [&scene, &hull, reach](Count) {
                     std::vector<closest_features::ClimbingRoot<K>> roots(
                         scene.trace.objects, closest_features::ClimbingRoot<K>(hull));
                     return at_roots(scene.trace, [&](std::size_t i, const Pose& pose,
                                                      const Vec3<double>& origin) {
                       return roots[i].bounds(pose, origin, reach * (1 + 1e-9));
                     });
                   },
                   {}});
}

/// How many answers are not those of the first cell with that query, which realigns.
std::size_t differing(const ReplayResult& a, const ReplayResult& b) {
  std::size_t count = a.contacts != b.contacts;
  for (std::size_t i = 0; i < a.touching.size(); ++i) count += a.touching[i] != b.touching[i];
  return count;
}

Row row_of(const std::string& mesh, double side, const Cell& cell, unsigned repetition,
           std::size_t pairs, const Measured& measured, const ReplayResult& truth) {
  const bool roots = cell.query == "roots";
  Row row{mesh, text_of(side), std::to_string(cell.k), cell.policy, cell.query};
  for (const std::uint64_t n :
       {std::uint64_t{repetition}, std::uint64_t{pairs},
        std::uint64_t{roots ? measured.dismissed : 0},
        std::uint64_t{roots ? 0 : differing(measured.replay, truth)}, cell.counted.hits,
        cell.counted.n_u, cell.counted.n_v, cell.counted.n_p})
    row.push_back(std::to_string(n));
  row.push_back(text_of(std::round(measured.pose_ns * 100) / 100));
  row.push_back(text_of(std::round(measured.replay.seconds * 1e9)));
  return row;
}

void measure_scene(const std::string& name, double side, const Scene& scene,
                   const closest_features::Polytope& hull, unsigned repetitions,
                   std::mt19937_64& random, StudyRecord& record) {
  std::vector<Cell> cells;
  add_policies<6>(scene, hull, cells);
  add_policies<14>(scene, hull, cells);
  add_policies<18>(scene, hull, cells);
  add_policies<26>(scene, hull, cells);
  std::map<std::string, ReplayResult> truth;
  for (auto& cell : cells) {
    cell.counted = cell.measure(Count::on).replay;
    truth.emplace(cell.query, cell.counted);
  }
  const std::size_t pairs = scene.trace.pairs() * scene.trace.frames;
  for (unsigned repetition = 0; repetition < repetitions; ++repetition) {
    std::shuffle(cells.begin(), cells.end(), random);
    for (const auto& cell : cells)
      record.add(row_of(name, side, cell, repetition, pairs, cell.measure(Count::off),
                        truth.at(cell.query)));
  }
}

void run(const StudyDefinition& definition, const std::filesystem::path& folder,
         const Progress& progress) {
  const auto sides = definition.numbers("sides");
  Wandering wandering(definition, sides[0]);
  StudyRecord record(definition, folder,
                     {"mesh", "side", "k", "policy", "query", "repetition", "pairs", "dismissed",
                      "differing", "hits", "n_u", "n_v", "n_p", "pose_ns", "time_ns"},
                     2, progress);
  std::mt19937_64 random(20260101);
  const std::size_t all = wandering.names.size() * sides.size();
  std::size_t done = 0;
  for (const auto& name : wandering.names) {
    const closest_features::Polytope hull(named_mesh(name + "-hull", wandering.polygons).mesh);
    for (const double side : sides) {
      wandering.side = side;
      if (!record.has({name, text_of(side)}))
        measure_scene(name, side, wandering.scene(name), hull, definition.repetitions, random,
                      record);
      record.save(++done, all);
    }
  }
}

}  // namespace

const StudyKind studies::posing = {
    "posing", "how K-DOPs are posed: by realignment, by their corners, roots by the hull",
    parameters, nullptr, run};

}  // namespace bvlab
