// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/predict.hpp"

#include <array>
#include <deque>
#include <memory>
#include <utility>

#include "experiments/replay/registry.hpp"
#include "traversal/all_pairs.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/queries/touching.hpp"
#include "traversal/strategies/adaptive.hpp"
#include "traversal/strategies/by_cost.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/recursive.hpp"
#include "traversal/strategies/separation_list.hpp"

namespace bvlab {
namespace {

/// Sums over runs.
struct Cost {
  double runs = 0, volumes = 0, triangles = 0;

  void add(const TraversalStatistics& statistics) {
    runs += 1;
    volumes += static_cast<double>(statistics.volumes);
    triangles += static_cast<double>(statistics.triangles);
  }
  void add(const Cost& other, double share = 1) {
    runs += share * other.runs;
    volumes += share * other.volumes;
    triangles += share * other.triangles;
  }
};

enum Rule { separation_list, deferred, by_cost, rules };

/// A front from the frame in which recursion left it, and what each rule has spent on it so far.
class Cycle {
 public:
  Cycle() { front_.restart(); }

  template <class Pair>
  void run(const Pair& pair) {
    const std::size_t before = front_.size();
    const TraversalStatistics statistics = pair.from_front(front_);
    const bool rebuild = age_++ == 0;
    for (int rule = 0; rule < rules; ++rule)
      if (!over_[rule]) costs_[rule].add(statistics);
    still_ = rebuild || front_.size() > before ? 0 : still_ + 1;
    over_[separation_list] = over_[separation_list] || still_ > 0;
    over_[deferred] = over_[deferred] || still_ > 1;
    const Cost& cost = costs_[by_cost];
    over_[by_cost] =
        over_[by_cost] || static_cast<double>(statistics.volumes) * cost.runs > cost.volumes;
  }

  bool over() const { return over_[0] && over_[1] && over_[2]; }
  std::size_t age() const { return age_; }
  const Cost& cost(int rule) const { return costs_[static_cast<std::size_t>(rule)]; }
  const Front& front() const { return front_; }

 private:
  Front front_;
  std::size_t age_ = 0;
  unsigned still_ = 0;  // runs in a row without growth
  std::array<bool, rules> over_{};
  std::array<Cost, rules> costs_;
};

/// What is known of one pair of bodies.
struct PairFronts {
  Cost recursive, both, margins;
  std::array<Cost, rules> lists;
  std::deque<Cycle> open;
  double displacement = -1, step = 0;
};

template <class Query>
class Predictor {
 public:
  Predictor(std::span<const TriangleMesh> meshes, std::size_t objects, const Variant& variant,
            const PredictOptions& options)
      : options_(options),
        pairs_(all_object_pairs(static_cast<std::uint32_t>(objects))),
        fronts_(pairs_.size()),
        hierarchies_(volume_entry(variant.volume).hierarchies(meshes, variant)),
        bodies_(loops_of<Query>(variant.volume).bodies(*hierarchies_, objects)) {}

  void frame(std::size_t number, std::span<const Pose> poses) {
    bodies_.move(poses, Vec3<double>::Zero());
    for (std::size_t p = 0; p < pairs_.size(); ++p) look_at(p, number);
  }

  std::vector<Predicted> result(std::size_t frames) {
    std::array<Cost, rules + 3> sums;
    for (PairFronts& pair : fronts_) {
      for (const Cycle& cycle : pair.open) close(pair, cycle);
      sums[0].add(pair.recursive), sums[1].add(pair.both);
      for (int rule = 0; rule < rules; ++rule)
        extend(sums[static_cast<std::size_t>(2 + rule)], pair.lists[static_cast<std::size_t>(rule)],
               frames);
      extend(sums[rules + 2], pair.margins, frames);
    }
    return {predicted(Recursive::name, sums[0], Adaptive::broad),
            predicted(RecursiveBoth::name, sums[1], Adaptive::broad),
            predicted(SeparationList::name, sums[2], Adaptive::plain),
            predicted(Deferred::name, sums[3], Adaptive::plain),
            predicted(ByCost::name, sums[4], Adaptive::plain),
            predicted(Margins::name, sums[5], Adaptive::careful)};
  }

 private:
  void look_at(std::size_t p, std::size_t number) {
    PairFronts& pair = fronts_[p];
    ask(p, [&](const auto& each) { pair.recursive.add(each.from_roots()); });
    ask(p, [&](const auto& each) { pair.both.add(each.template from_roots<NoFrontBoth>()); });
    const bool begins = number % options_.stride == 0;
    if (begins) pair.open.emplace_back();
    for (Cycle& cycle : pair.open) ask(p, [&](const auto& each) { cycle.run(each); });
    ask(p, [&](const auto& each) { follow(pair, each.a(), each.b()); });
    if (begins && number > 0) measure_gaps(p, pair);
    std::erase_if(pair.open, [&](const Cycle& cycle) {
      const bool over = cycle.over() || cycle.age() == options_.longest;
      if (over) close(pair, cycle);
      return over;
    });
  }

  static void close(PairFronts& pair, const Cycle& cycle) {
    for (int rule = 0; rule < rules; ++rule)
      pair.lists[static_cast<std::size_t>(rule)].add(cycle.cost(rule));
  }

  static void follow(PairFronts& pair, MovingBody& a, MovingBody& b) {
    const double displacement = a.displacement_bound() + b.displacement_bound();
    pair.step = pair.displacement < 0 ? 0 : displacement - pair.displacement;
    pair.displacement = displacement;
  }

  /// One run with margins over the front that recursion has just left: what of it would come up.
  void measure_gaps(std::size_t p, PairFronts& pair) {
    Margins margins;
    ask(p, [&](const auto& each) {
      const Front& front = pair.open.back().front();
      margins.start_from(front, front.size(), each.a(), each.b(), pair.step);
      Cost run;
      run.add(margins.run(each));
      const double due = pair.step > 0 ? margins.due_in_a_run(pair.step) : 0;
      pair.margins.runs += 1;
      pair.margins.volumes += due * run.volumes;
      pair.margins.triangles += due * run.triangles;
    });
  }

  template <class Run>
  void ask(std::size_t p, Run&& run) {
    found_.clear();
    Query query = [&] {
      if constexpr (std::same_as<Query, Contacts>)
        return Contacts(found_);
      else
        return Query();
    }();
    NotCounting counter;
    run(bodies_.pair(pairs_[p], query, counter));
  }

  /// As many runs as there are frames, each at the mean cost.
  static void extend(Cost& sum, const Cost& of_some, std::size_t frames) {
    if (of_some.runs > 0) sum.add(of_some, static_cast<double>(frames) / of_some.runs);
  }

  static Predicted predicted(std::string_view strategy, const Cost& cost,
                             const Adaptive::Prices& prices) {
    const double ns =
        prices.run * cost.runs + prices.volumes * cost.volumes + prices.triangles * cost.triangles;
    return {strategy, cost.volumes, cost.triangles, 1e-9 * ns};
  }

  PredictOptions options_;
  std::vector<ObjectPair> pairs_;
  std::vector<PairFronts> fronts_;
  std::unique_ptr<AnyHierarchies> hierarchies_;
  AnyBodies<Query, NotCounting> bodies_;
  std::vector<Contact> found_;
};

template <class Query>
std::vector<Predicted> predict_under(std::span<const TriangleMesh> meshes, const Trace& trace,
                                     const Variant& variant, const PredictOptions& options) {
  Predictor<Query> predictor(meshes, trace.objects, variant, options);
  std::vector<Pose> poses(trace.objects);
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    trace.poses(frame, poses);
    predictor.frame(frame, poses);
  }
  return predictor.result(trace.frames);
}

}  // namespace

std::vector<Predicted> predict(std::span<const TriangleMesh> meshes, const Trace& trace,
                               const Variant& variant, const PredictOptions& options) {
  check(variant);
  return variant.query == Contacts::name ? predict_under<Contacts>(meshes, trace, variant, options)
                                         : predict_under<Touching>(meshes, trace, variant, options);
}

}  // namespace bvlab
