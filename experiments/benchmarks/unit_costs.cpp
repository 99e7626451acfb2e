// SPDX-License-Identifier: BSD-3-Clause
/// The unit costs of T = N_u C_u + N_v C_v + N_p C_p: nanoseconds to pose a volume, to test a pair
/// of volumes and to test a pair of triangles, on what a traversal meets: two meshes that overlap.
///
///   place/<volume>           a pose made ready for the volume, once for a body that moved
///   pose/<volume>            C_u, siblings together, as a body poses them
///   test/<volume>/<n>/<kind> C_v, n pairs at a time, gathering included; kind: apart or meeting
///   gap/<volume>/<n>         the same for the distance between two volumes
///   triangles/<precision>/<kind>  C_p, sixteen candidates at a time; kind: apart or meeting
#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "experiments/scenes/named_mesh.hpp"
#include "hierarchies/builds.hpp"
#include "hierarchies/volumes.hpp"
#include "traversal/body.hpp"
#include "traversal/counters.hpp"
#include "traversal/gather.hpp"
#include "traversal/primitives/triangle_intersection.hpp"

namespace bvlab {
namespace {

constexpr std::size_t sample = 1024;  // pairs: they stay in the second cache
constexpr std::size_t polygons = 500;

const TriangleMesh& mesh() {
  static const TriangleMesh it = named_mesh("bunny", polygons).mesh;
  return it;
}

/// Turned some way, half a body's width off: surfaces run through each other.
Pose pose(int turn) {
  const double angle = 0.37 * turn;
  const double width = (mesh().vertices[0] - mesh().vertices[mesh().vertices.size() / 2]).norm();
  return *pose_from(Vec3<double>(0.3 * width * (turn % 2), 0.1 * width, 0), std::cos(angle),
                    std::sin(angle), 0.3, 0.1);
}

void per(benchmark::State& state, std::size_t calls) {
  state.counters["ns"] = benchmark::Counter(
      static_cast<double>(calls) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class V>
struct Overlapping {
  Hierarchy<V> hierarchy{mesh(), builds::TopDownPrincipal::topology(mesh(), 1)};
  Body<V> a{mesh(), hierarchy}, b{mesh(), hierarchy};
  std::vector<std::uint32_t> nodes_a[2], nodes_b[2];  // [meet]

  Overlapping() {
    a.move(pose(0), Vec3<double>::Zero());
    b.move(pose(1), Vec3<double>::Zero());
    pose_all(a), pose_all(b);
    // What a recursion meets: children of pairs that meet.
    std::mt19937 random(1);
    for (int tries = 0; tries < 1000000 && few(); ++tries) {
      std::uint32_t i = 0, j = 0;
      while (true) {
        const bool meet = !disjoint(a.volumes()[i], b.volumes()[j]);
        add(meet, i, j);
        const auto& p = hierarchy.node(i);
        const auto& q = hierarchy.node(j);
        if (!meet || (p.count && q.count)) break;
        if (p.count || (!q.count && q.size > p.size))
          j = q.first + random() % 2;
        else
          i = p.first + random() % 2;
      }
    }
  }

  void pose_all(Body<V>& body) const {
    std::size_t posed = 0;
    for (std::uint32_t node = 0; node < hierarchy.size(); ++node) body.require(node, posed);
  }

 private:
  bool few() const { return nodes_a[0].size() < sample || nodes_a[1].size() < sample; }
  void add(bool meet, std::uint32_t i, std::uint32_t j) {
    if (nodes_a[meet].size() == sample) return;
    nodes_a[meet].push_back(i), nodes_b[meet].push_back(j);
  }
};

template <class V>
Overlapping<V>& overlapping() {
  static Overlapping<V> it;
  return it;
}

/// Applies `test` to the pairs, W at a time.
template <class V, int W, class Test>
void in_batches(benchmark::State& state, bool meet, Test test) {
  auto& two = overlapping<V>();
  const auto &i = two.nodes_a[meet], &j = two.nodes_b[meet];
  const std::size_t count = i.size() / 16 * 16;
  for (auto _ : state)
    for (std::size_t k = 0; k < count; k += W) {
      if constexpr (W == 1) {
        benchmark::DoNotOptimize(test(two.a.volumes()[i[k]], two.b.volumes()[j[k]]));
      } else {
        using B = Batch<typename V::scalar, W>;
        benchmark::DoNotOptimize(
            test(gather<B>(two.a.volumes(), &i[k]), gather<B>(two.b.volumes(), &j[k])));
      }
    }
  per(state, count);
}

template <class V>
void measure() {
  using benchmark::RegisterBenchmark;
  const std::string name(V::name);
  RegisterBenchmark(("place/" + name).c_str(), [](benchmark::State& state) {
    auto& two = overlapping<V>();
    int turn = 0;
    for (auto _ : state) benchmark::DoNotOptimize(two.a.move(pose(++turn), Vec3<double>::Zero()));
    two.a.move(pose(0), Vec3<double>::Zero());
    two.pose_all(two.a);
    per(state, 1);
  });
  RegisterBenchmark(("pose/" + name).c_str(), [](benchmark::State& state) {
    auto& two = overlapping<V>();
    int turn = 0;
    for (auto _ : state) {
      two.a.move(pose(++turn), Vec3<double>::Zero());
      two.pose_all(two.a);
    }
    two.a.move(pose(0), Vec3<double>::Zero());
    two.pose_all(two.a);
    per(state, two.hierarchy.size());
  });
  const auto test = [](const auto& p, const auto& q) { return bits(disjoint(p, q)); };
  constexpr int widest = std::max(4, native_width<typename V::scalar>);
  for (const bool meet : {false, true}) {
    const std::string kind = meet ? "meeting" : "apart";
    RegisterBenchmark(("test/" + name + "/1/" + kind).c_str(),
                      [=](benchmark::State& state) { in_batches<V, 1>(state, meet, test); });
    RegisterBenchmark(("test/" + name + "/" + std::to_string(widest) + "/" + kind).c_str(),
                      [=](benchmark::State& state) { in_batches<V, widest>(state, meet, test); });
  }
  RegisterBenchmark(
      ("gap/" + name + "/" + std::to_string(widest)).c_str(), [](benchmark::State& state) {
        in_batches<V, widest>(state, false, [](const auto& p, const auto& q) { return gap(p, q); });
      });
}

template <class Precision>
void measure_triangles(bool meet) {
  const std::string name =
      "triangles/" + std::string(Precision::name) + (meet ? "/meeting" : "/apart");
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    using V = Volumes::at<0>;
    static Overlapping<V>& two = overlapping<V>();
    std::vector<const Triangle*> as, bs;
    for (std::uint32_t i = 0; i < two.hierarchy.primitives(); ++i)
      for (std::uint32_t j = 0; j < two.hierarchy.primitives(); ++j) {
        const Triangle &p = two.a.triangle(i), &q = two.b.triangle(j);
        // Apart, but near: what volumes leave over.
        const double reach = (p[0] - p[1]).norm() + (q[0] - q[1]).norm();
        if (as.size() < sample && (p[0] - q[0]).norm() < reach && intersect(p, q) == meet)
          as.push_back(&p), bs.push_back(&q);
      }
    const std::size_t count = as.size() / 16 * 16;
    for (auto _ : state)
      for (std::size_t k = 0; k < count; k += 16)
        benchmark::DoNotOptimize(intersect_batch<Precision>(&as[k], &bs[k], 16));
    per(state, count);
  });
}

void measure_everything() {
  Volumes::for_each([]<class V>(std::type_identity<V>) { measure<V>(); });
  Precisions::for_each([]<class P>(std::type_identity<P>) {
    measure_triangles<P>(false);
    measure_triangles<P>(true);
  });
}

}  // namespace
}  // namespace bvlab

int main(int argc, char** argv) {
  bvlab::measure_everything();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
