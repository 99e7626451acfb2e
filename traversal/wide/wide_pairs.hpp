// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of bodies over wide trees: pairs in slots, as AllPairsOf and WorldOf use them. Early tests
/// decide most pairs, a register of pairs at a time (early_culling.hpp); the rest are traversed,
/// two pairs interleaved. Answers come first for pairs that were decided early, then for those that
/// are traversed, as they end.
///
/// The Memory says what pairs keep from frame to frame: NoMemory, a list (list_memory.hpp) or
/// WideMargins. The Kernel says what one step of a traversal tests (kernels.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchies/geometry/threads.hpp"
#include "hierarchies/geometry/unless_done.hpp"
#include "traversal/counters.hpp"
#include "traversal/frame.hpp"
#include "traversal/shape.hpp"
#include "traversal/wide/siblings_kernel.hpp"
#include "traversal/wide/wide_margins.hpp"
#include "traversal/wide/wide_pair.hpp"

namespace bvlab {

template <class V, int F, class Kernel = SiblingsKernel>
using WideShape = ShapeOver<typename Kernel::template Hierarchy<V, F>>;

/// Hierarchies that may have been made on demand.
template <class Hierarchy>
concept MadeOnDemand = requires(const Hierarchy& hierarchy) { hierarchy.mesh_of_supports(); };

template <class V, int F, class Memory = NoMemory, class Kernel = SiblingsKernel>
class WidePairs {
  using Body = typename Kernel::template Body<V, F>;
  using Hierarchy = typename Kernel::template Hierarchy<V, F>;

 public:
  /// One body for each shape, which must outlive this.
  /// `frame` is for bodies of AnyVolume; all others are tested in a body's frame.
  [[gnu::noinline]] explicit WidePairs(std::span<const WideShape<V, F, Kernel>> shapes,
                                       Memory memory = {}, Frame frame = Frame::body)
      : memory_(std::move(memory)), frame_(frame) {
    bodies_.reserve(shapes.size());
    for (const auto& shape : shapes) add(shape);
  }

  [[gnu::noinline]] void add(const WideShape<V, F, Kernel>& shape) {
    const auto& [mesh, hierarchy] = shape;
    if constexpr (takes_frames)
      bodies_.emplace_back(*mesh, *hierarchy, frame_);
    else
      bodies_.emplace_back(*mesh, *hierarchy);
    meshes_.push_back(mesh);
    [[maybe_unused]] const bool is_first = culling_.add_body(hierarchy->supports());
    if constexpr (MadeOnDemand<Hierarchy>)
      if (is_first && hierarchy->mesh_of_supports()) {
        without_supports_.push_back(hierarchy);
        cost_of_supports_ += traversals_for_map(*hierarchy->mesh_of_supports());
      }
    const auto& sphere = hierarchy->sphere();
    memory_.add_body({sphere.centre, sphere.radius, hierarchy->reach(), hierarchy->size(), 0,
                      hierarchy->origin()});
  }

  std::size_t size() const { return bodies_.size(); }
  const TriangleMesh& mesh(std::size_t i) const { return *meshes_[i]; }
  /// See LocalMesh.
  const Vec3<double>& mesh_origin(std::size_t i) const { return bodies_[i].hierarchy().origin(); }

  void put(std::uint32_t slot, const ObjectPair& pair) {
    if (slot >= most_pairs) fail(std::length_error("wide trees: more than 2^30 pairs of bodies"));
    if (slot >= pairs_.size()) memory_.resize(slot + 1), pairs_.resize(slot + 1);
    pairs_[slot] = pair;
  }
  void drop(std::uint32_t slot) { memory_.forget(slot); }

  void make_room(const Threads& threads) {
    if (workers_.size() < threads.count()) workers_.resize(threads.count());
  }

  /// Begins a frame in which every body may have moved, and moves all. `poses` and `origin` must
  /// remain valid until its end.
  template <class Counter, class MakeQuery>
  void begin_all(std::span<const Pose> poses, const Vec3<double>& origin, Threads& threads,
                 Counter&, MakeQuery& make_query) {
    begin_frame<std::remove_cvref_t<decltype(make_query(0, ObjectPair{}))>>(poses, origin, threads);
    move_all(threads);
  }

  /// Begins a frame in which `movers` have moved. `poses`, of all bodies, and `origin` must remain
  /// valid until its end; `origin` need not be known yet.
  template <class Query>
  void begin(std::span<const std::uint32_t> movers, std::span<const Pose> poses,
             const Vec3<double>& origin, const Threads& threads) {
    begin_frame<Query>(poses, origin, threads);
    for (const auto i : moved_) memory_.rest(i);
    moved_.assign(movers.begin(), movers.end());
  }
  /// Sets the pose of one of the movers, on any thread.
  [[gnu::noinline]] void set_pose(std::uint32_t i) {
    move(i);
    require(i);
  }

  /// Queries the pairs in `slots` as worker `number`, which is below the number of threads: decides
  /// some by early tests, and traverses the rest. Calls `make_query(slot, pair)` and `take(slot,
  /// pair, query)`. A second query may be made for a pair, to test triangles that a Memory kept; it
  /// is never passed to `take`.
  ///
  /// A traversal counts in any case, in registers: it is compiled once, and not for each counter.
  template <class Slots, class Counter, class MakeQuery, class Take>
  void run(const Slots& slots, std::size_t number, Counter& counter, MakeQuery&& make_query,
           Take&& take) {
    Counting counting;
    run_counting(slots, number, counting, make_query, take);
    counter.add(counting);
  }

  const std::vector<ObjectPair>& pairs() const { return pairs_; }
  /// Entries of all fronts, or of one pair's. An entry is a step's pair of nodes with the lanes it
  /// opened, or a triangle against a leaf.
  std::size_t front_size() const { return memory_.front_size(); }
  std::size_t front_size(std::uint32_t slot) const { return memory_.front_size(slot); }
  /// Counts the volumes that have been posed into the world since this was called last.
  template <class Counter>
  void count_posed(Counter& counter) requires requires(Body& body) {
    body.posed();
  }
  {
    for (const Body& body : bodies_)
      if (body.posed()) counter.posed(body.posed()->take_posed());
  }

 private:
  static constexpr bool takes_frames = requires(Body & body) { body.posed(); };
  static constexpr std::size_t at_once = 2;
  static constexpr std::uint32_t most_pairs = 1u << 30;  // early tests gather at 2 p, an int32

  /// What a thread needs for itself, in cache lines of its own.
  struct alignas(128) Worker {
    std::array<WideWorkspace, at_once> workspaces;
    PairSieve sieve;
    std::uint64_t traversals = 0;
  };

  /// About how many traversals of two bodies take as long as making a mesh's support map.
  static std::uint64_t traversals_for_map(const TriangleMesh& mesh) {
    return 64 + mesh.vertices.size() / 32;
  }
  /// Trees on demand begin without support maps, which would decide some pairs before they are
  /// traversed. They are made once traversals have taken as long as that will.
  void make_supports() {
    if (without_supports_.empty()) return;
    std::uint64_t traversals = 0;
    for (const Worker& worker : workers_) traversals += worker.traversals;
    if (traversals < cost_of_supports_) return;
    if constexpr (MadeOnDemand<Hierarchy>) {
      std::vector<const SupportMap*> empty;
      for (const Hierarchy* hierarchy : without_supports_) empty.push_back(&hierarchy->supports());
      culling_.make_maps(empty, [&](std::size_t k) {
        const Hierarchy& of = *without_supports_[k];
        return SupportMap(*of.mesh_of_supports(), of.sphere().centre);
      });
    }
    without_supports_.clear(), cost_of_supports_ = 0;
  }

  template <class Query>
  void begin_frame(std::span<const Pose> poses, const Vec3<double>& origin,
                   const Threads& threads) {
    make_room(threads);
    make_supports();
    poses_ = poses, origin_ = &origin;
    memory_.template begin_frame<Query>();
  }
  /// Out of line, as all that is the same for every query.
  [[gnu::noinline]] void move_all(Threads& threads) {
    if (threads.count() == 1)
      for (std::size_t i = 0; i < bodies_.size(); ++i) move(i);
    else
      threads.share_out(bodies_.size(), 16, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) set_pose(static_cast<std::uint32_t>(i));
      });
  }
  void move(std::size_t i) { memory_.move(i, bodies_[i], poses_[i], culling_, *origin_); }
  void require(std::size_t i) {
    memory_.require(bodies_[i], poses_[i]);
    if constexpr (takes_frames) bodies_[i].place(*origin_);
  }

  template <class Slots, class MakeQuery, class Take>
  void run_counting(const Slots& slots, std::size_t number, Counting& counter,
                    MakeQuery& make_query, Take& take) {
    using Query = std::remove_cvref_t<decltype(make_query(0, pairs_[0]))>;
    static_assert(for_wide_trees<Query>(),
                  "wide trees cull by `disjoint`: a query says `culls_disjoint`, or wants a bound");
    Worker& worker = workers_[number];
    PairSieve& sieve = worker.sieve;
    sieve.begin(slots.size());
    const auto repeat = [&](std::uint32_t p) {
      Query query = make_query(p, pairs_[p]);
      memory_.repeat(p, query);
      take(p, pairs_[p], query);
    };
    for (const std::uint32_t p : slots)
      if (memory_.template answer_valid<Query>(p, pairs_[p]))
        repeat(p);
      else
        sieve.add(p);
    const std::uint64_t before = counter.tests();
    // One test of each pair's bodies as a whole: by spheres, or by their motion since the last one.
    counter.bodies(sieve.undecided().size());
    if constexpr (!wants_bound<Query>()) {
      memory_.template cull<Query>(sieve, {pairs_, poses_, meshes_, culling_}, counter, make_query);
      if (without_supports_.empty()) {
        counter.bodies(culling_.cull_by_directions(
            sieve, pairs_, [&](std::size_t p) { return memory_.skips_directions(p); },
            [&](std::size_t p, double gap) { memory_.apart(p, pairs_[p], gap); }));
      } else {
        // No node is made of bodies whose spheres are apart.
        const std::size_t known = sieve.decided().size();
        culling_.cull_by_spheres(sieve, pairs_);
        for (const std::int32_t p : sieve.decided().subspan(known))
          memory_.apart(static_cast<std::size_t>(p), pairs_[static_cast<std::size_t>(p)], 0);
      }
      for (const std::int32_t p : sieve.decided()) {
        counter.queried(before);
        repeat(static_cast<std::uint32_t>(p));
      }
    }
    traverse_interleaved<Query>(sieve.undecided(), worker, before, counter, make_query, take);
  }

  /// `before`: tests before the first of these pairs.
  template <class Query, class MakeQuery, class Take>
  void traverse_interleaved(std::span<const std::int32_t> near, Worker& worker,
                            std::uint64_t before, Counting& counter, MakeQuery& make_query,
                            Take& take) {
    // Fronts of traversals that did not end may lack entries.
    UnlessDone undo([&] {
      for (const std::int32_t p : near) drop(static_cast<std::uint32_t>(p));
    });
    using Lanes = typename Kernel::template PairFrame<V, F>::S;
    using Record = typename Memory::template Record<Lanes>;
    struct Running {
      std::uint32_t pair;
      std::optional<Query> query;
      std::optional<Traversal<WidePair<V, F, Kernel>, Query, Counting, Record>> traversal;
    };
    worker.traversals += near.size();
    std::array<Running, at_once> all;
    std::array<Running*, at_once> running;
    std::size_t next = 0, active = 0;
    const auto begin = [&](std::size_t k) {
      const std::uint32_t p = near[next++];
      Running& now = *running[k];
      const auto [i, j] = pairs_[p];
      require(i), require(j);
      now.pair = p;
      now.query.emplace(make_query(p, pairs_[p]));
      now.traversal.emplace(bodies_[i], bodies_[j], *now.query, counter,
                            worker.workspaces[static_cast<std::size_t>(&now - all.data())],
                            memory_.template start<Query>(p, pairs_[p]));
    };
    for (; active < at_once && next < near.size(); ++active) {
      running[active] = &all[active];
      begin(active);
    }
    while (active > 0)
      for (std::size_t k = 0; k < active;) {
        Running& now = *running[k];
        if (now.traversal->advance()) {
          ++k;
          continue;
        }
        counter.queried(before);
        memory_.remember(now.pair, pairs_[now.pair], *now.query, now.traversal->recorder());
        take(now.pair, pairs_[now.pair], *now.query);
        if (next < near.size()) {
          begin(k++);
        } else {
          --active;
          std::swap(running[k], running[active]);
        }
      }
    undo.is_done();
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Body> bodies_;
  std::vector<const TriangleMesh*> meshes_;
  EarlyCulling culling_;
  std::vector<const Hierarchy*> without_supports_;
  std::uint64_t cost_of_supports_ = 0;  // of these, in traversals
  std::vector<Worker> workers_;
  const Vec3<double>* origin_ = nullptr;  // of the spheres in culling_
  [[no_unique_address]] Memory memory_;
  Frame frame_;
  std::span<const Pose> poses_;
  std::vector<std::uint32_t> moved_;  // in the frame that `begin` began last
};

}  // namespace bvlab
