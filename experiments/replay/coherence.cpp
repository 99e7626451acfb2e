// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/coherence.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "experiments/replay/registry.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/queries/distance.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/strategies/rising_front.hpp"

namespace bvlab {
namespace {

template <class Query>
Query asked(std::vector<Contact>& found) {
  if constexpr (std::same_as<Query, Contacts>)
    return Contacts(found);
  else
    return Query();
}

/// Half the mean of the longest edges.
double leaf_size_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle c = mesh.corners(t);
    sum += std::max({(c[0] - c[1]).norm(), (c[1] - c[2]).norm(), (c[2] - c[0]).norm()});
  }
  return sum / 2 / static_cast<double>(std::max<std::size_t>(mesh.triangles.size(), 1));
}

/// A mesh's middle and how far from it the mesh reaches.
struct Middle {
  Vec3<double> centre;
  double radius = 0;

  explicit Middle(const TriangleMesh& mesh) {
    Vec3<double> low = mesh.vertices[0], high = low;
    for (const auto& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    centre = (low + high) / 2;
    for (const auto& v : mesh.vertices) radius = std::max(radius, (v - centre).norm());
  }
};

/// No point of the body has moved farther: |R - R'| = 2 sqrt(2) sin(angle / 2) in Frobenius' norm.
double motion(const Middle& middle, const Pose& from, const Pose& to) {
  return (to(middle.centre) - from(middle.centre)).norm() +
         (to.rotation - from.rotation).norm() / std::sqrt(2.0) * middle.radius;
}

/// The bodies of a trace, of which fronts are asked by one query and distances by another.
template <class Query>
class CoherenceMeter {
 public:
  CoherenceMeter(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant)
      : pairs_(object_pairs(trace)),
        fronts_(pairs_.size()),
        past_(pairs_.size()),
        hierarchies_(volume_entry(variant.volume).hierarchies(meshes, variant)),
        bodies_(bodies_entry<Query>(variant.volume)
                    .bodies(*hierarchies_, trace.objects, frame_of(variant))),
        apart_(bodies_entry<Distance>(variant.volume)
                   .bodies(*hierarchies_, trace.objects, frame_of(variant))) {
    for (const auto& mesh : meshes) {
      middles_.emplace_back(mesh);
      leaf_sizes_.push_back(leaf_size_of(mesh));
    }
  }

  void frame(std::span<const Pose> poses, const std::function<void()>& waiting) {
    const bool first = before_.empty();
    bodies_.move(poses, Vec3<double>::Zero());
    apart_.move(poses, Vec3<double>::Zero());
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      first ? (void)(past_[p].complete = fresh_front(p, fronts_[p]).everything) : look_at(p, poses);
      waiting();
    }
    before_.assign(poses.begin(), poses.end());
  }

  const CoherenceSums& sums() const { return sums_; }

 private:
  void look_at(std::size_t p, std::span<const Pose> poses) {
    ++sums_.pair_runs;
    const Front before = fronts_[p];
    const std::size_t entries = before.size();
    const TraversalStatistics fresh = fresh_front(p, fronts_[p]);
    const bool complete = std::exchange(past_[p].complete, fresh.everything) && fresh.everything;
    const bool is_near = entries > 1 || fronts_[p].size() > 1;
    Front last = before;
    const std::uint64_t again = is_near ? ask(p, last).volumes : 1;
    const std::size_t kept = shared(before, fronts_[p]);
    const Step step = step_of(entries, last, fronts_[p], kept);
    follow(past_[p], p, fresh, complete, step);
    if (!is_near) return;
    if (complete && (step == Step::still || step == Step::up)) past_[p].one = {before, step};
    ++sums_.near_runs;
    sums_.tests += fresh.volumes;
    sums_.entries += entries;
    sums_.kept += kept;
    sums_.again += again;
    sums_.grown += last.size() - entries;
    if (last.size() == entries) ++sums_.still_runs, sums_.still_entries += entries;
    if (complete) {
      StepSums& sums = sums_.steps[static_cast<std::size_t>(step)];
      ++sums.runs, sums.entries += entries, sums.tests += fresh.volumes, sums.again += again;
      sums.raised += again + parents_tried(p, before, last);
    }
    measure_motion(pairs_[p], poses);
  }

  /// `last` is the front of the frame before, run through again; `kept` of its entries are in both.
  Step step_of(std::size_t entries, const Front& last, const Front& now, std::size_t kept) {
    if (kept == entries && entries == now.size()) return Step::still;
    if (last.size() == entries) return Step::up;
    return last.size() == now.size() && shared(last, now) == now.size() ? Step::down : Step::mixed;
  }

  /// Parents that are tested where the entries that were not descended may rise.
  std::uint64_t parents_tried(std::size_t p, const Front& before, const Front& last) {
    RisingFront rising;
    shared(before, last);
    for (const NodePair& entry : shared_) rising.add(entry);
    const std::uint64_t tests = ask(p, rising).volumes;
    return tests - shared(rising, last);  // what has not risen is tested, too
  }

  /// A list that has not grown, and the step of its first run.
  struct Kept {
    Front list;
    Step first = Step::still;
  };
  struct Past {
    bool complete = false;                             ///< the last recursion
    std::optional<Kept> one;                           ///< after one run without growth
    std::optional<std::pair<Front, std::size_t>> two;  ///< after two; their place in two_runs
  };

  void follow(Past& past, std::size_t p, const TraversalStatistics& fresh, bool complete,
              Step step) {
    if (auto two = std::exchange(past.two, std::nullopt); two && complete) {
      TwoRunSums& sums = sums_.two[two->second];
      ++sums.runs, sums.kept += ask(p, two->first).volumes, sums.rebuilt += fresh.volumes;
    }
    if (auto one = std::exchange(past.one, std::nullopt); one && complete) {
      const std::size_t entries = one->list.size();
      ask(p, one->list);
      const auto is_it = [&](const TwoRuns& t) {
        return t.first == one->first && t.second == step;
      };
      const auto at = std::find_if(two_runs.begin(), two_runs.end(), is_it);
      if (one->list.size() == entries && at != two_runs.end())
        past.two = {std::move(one->list), static_cast<std::size_t>(at - two_runs.begin())};
    }
  }

  void measure_motion(const ObjectPair& pair, std::span<const Pose> poses) {
    const auto of = [&](std::uint32_t i) {
      return motion(middles_[i % middles_.size()], before_[i], poses[i]);
    };
    const double moved = of(pair.i) + of(pair.j);
    if (moved == 0) return;
    ++sums_.moved_runs;
    const double leaf =
        (leaf_sizes_[pair.i % leaf_sizes_.size()] + leaf_sizes_[pair.j % leaf_sizes_.size()]) / 2;
    if (leaf > 0) sums_.motion_leaf += moved / leaf;
    Distance query(0.1);
    NotCounting counter;
    apart_.pair(pair, query, counter).from_roots();
    sums_.motion_gap += moved < query.distance() ? moved / query.distance() : 1;
  }

  TraversalStatistics fresh_front(std::size_t p, Front& front) {
    front = Front();
    front.restart();
    return ask(p, front);
  }

  template <class AnyFront>
  TraversalStatistics ask(std::size_t p, AnyFront& front) {
    found_.clear();
    Query query = asked<Query>(found_);
    NotCounting counter;
    return bodies_.pair(pairs_[p], query, counter).from_front(front);
  }

  /// How many entries are in both: those in `shared_`.
  std::size_t shared(const Front& a, const Front& b) {
    const auto before = [](const NodePair& x, const NodePair& y) {
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    };
    old_.assign(a.entries().begin(), a.entries().end());
    new_.assign(b.entries().begin(), b.entries().end());
    std::sort(old_.begin(), old_.end(), before);
    std::sort(new_.begin(), new_.end(), before);
    shared_.clear();
    std::set_intersection(old_.begin(), old_.end(), new_.begin(), new_.end(),
                          std::back_inserter(shared_), before);
    return shared_.size();
  }

  std::vector<ObjectPair> pairs_;
  std::vector<Front> fronts_;
  std::vector<Past> past_;
  std::unique_ptr<AnyHierarchies> hierarchies_;
  AnyBodies<Query> bodies_;
  AnyBodies<Distance> apart_;
  std::vector<Middle> middles_;
  std::vector<double> leaf_sizes_;
  std::vector<Pose> before_;
  std::vector<NodePair> old_, new_, shared_;
  std::vector<Contact> found_;
  CoherenceSums sums_;
};

/// How well a separation list could have done: the rebuilds that cost the fewest tests of volumes,
/// found afterwards. What any rule for rebuilding is to be compared with.
///
/// The state of a list in run f depends on nothing but the run r <= f in which it was rebuilt last;
/// so c(r, f), the tests it makes in run f, is measured by letting a list live from every r to the
/// end. Then
///
///   best(f) = min over r <= f of best(r - 1) + c(r, r) + ... + c(r, f),   best(-1) = 0,
///
/// is the least that can be reached: exact, by O(frames^2) runs for every pair.
template <class Query>
class RebuildSearch {
 public:
  explicit RebuildSearch(AnyBodies<Query> bodies) : bodies_(std::move(bodies)) {}

  /// `poses[f]` are all bodies' in frame f.
  BestRebuilds search(const ObjectPair& pair, const std::vector<std::vector<Pose>>& poses) {
    const std::size_t n = poses.size();
    constexpr auto never = std::numeric_limits<std::uint64_t>::max();
    // before[f] is of all runs before f.
    std::vector<BestRebuilds> before(n + 1, BestRebuilds{never, 0});
    before[0] = {};
    for (std::size_t r = 0; r < n; ++r) {
      Front front;
      front.restart();
      std::uint64_t tests = before[r].tests;
      for (std::size_t f = r; f < n; ++f) {
        for (const auto k : {pair.i, pair.j}) bodies_.move(k, poses[f][k], Vec3<double>::Zero());
        tests += run(pair, front);
        if (tests < before[f + 1].tests) before[f + 1] = {tests, before[r].rebuilds + 1};
      }
    }
    return before[n];
  }

 private:
  std::uint64_t run(const ObjectPair& pair, Front& front) {
    NotCounting counter;
    found_.clear();
    Query query = asked<Query>(found_);
    return bodies_.pair(pair, query, counter).from_front(front).volumes;
  }

  AnyBodies<Query> bodies_;
  std::vector<Contact> found_;
};

template <class Query>
CoherenceSums coherence_under(std::span<const TriangleMesh> meshes, const Trace& trace,
                              const Variant& variant, const std::function<void()>& waiting) {
  CoherenceMeter<Query> meter(meshes, trace, variant);
  std::vector<Pose> poses(trace.objects);
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    meter.frame(poses, waiting);
  }
  return meter.sums();
}

template <class Query>
BestRebuilds best_rebuilds_under(std::span<const TriangleMesh> meshes, const Trace& trace,
                                 const Variant& variant) {
  std::vector<std::vector<Pose>> poses(trace.frames, std::vector<Pose>(trace.objects));
  for (std::size_t frame = 0; frame < trace.frames; ++frame) trace.poses(frame, poses[frame]);
  const auto hierarchies = volume_entry(variant.volume).hierarchies(meshes, variant);
  RebuildSearch<Query> search(AnyBodies<Query>(
      bodies_entry<Query>(variant.volume).bodies(*hierarchies, trace.objects, frame_of(variant))));
  BestRebuilds sum;
  for (const auto& pair : object_pairs(trace)) {
    const BestRebuilds best = search.search(pair, poses);
    sum.tests += best.tests, sum.rebuilds += best.rebuilds;
  }
  return sum;
}

}  // namespace

CoherenceSums coherence(std::span<const TriangleMesh> meshes, const Trace& trace,
                        const Variant& variant, const std::function<void()>& waiting) {
  check(variant);
  return variant.query == Contacts::name
             ? coherence_under<Contacts>(meshes, trace, variant, waiting)
             : coherence_under<Touching>(meshes, trace, variant, waiting);
}

BestRebuilds best_rebuilds(std::span<const TriangleMesh> meshes, const Trace& trace,
                           const Variant& variant) {
  check(variant);
  return variant.query == Contacts::name ? best_rebuilds_under<Contacts>(meshes, trace, variant)
                                         : best_rebuilds_under<Touching>(meshes, trace, variant);
}

}  // namespace bvlab
