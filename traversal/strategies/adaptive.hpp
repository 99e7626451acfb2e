// SPDX-License-Identifier: BSD-3-Clause
/// Recursion (both nodes of a pair descended at once), a list or margins, whichever is cheapest for
/// this pair.
///
/// Costs are counted, not timed, so that runs repeat: pairs of volumes and of triangles tested,
/// each at what it costs in that way (`Prices`). Either way keeps a balance of what it cost over
/// what the other would have, and gives up when it has lost what it takes to come back; it is tried
/// again once 32 times that has been spent, or when the step has halved. So trials in vain cost a
/// thirty-second part, and what the others would cost is known mostly without trying them:
///
/// - A rebuild of a list is a recursion.
/// - Margins start from a list's entries, which takes one test of each, not from the roots, and the
///   gaps found say how often each entry is going to come up. How long a list would be, they know.
/// - Where a hit settles the query, a list with its witness is both: whether the witness is one
///   still is asked of its triangles alone, with a margin where bodies are slow, and no volume is
///   posed before it is lost.
///
/// Bodies at rest are not asked again, those whose balls are apart are told by their translations,
/// and those whose roots are apart by one margin, so that they need not be posed.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <string_view>

#include "traversal/fronts.hpp"
#include "traversal/strategies/margins.hpp"

namespace bvlab {

class Adaptive {
 public:
  static constexpr std::string_view name = "adaptive";
  static constexpr std::string_view description =
      "recursion, a list or margins, whichever is expected to be cheapest";

  /// Nanoseconds of a run, of a pair of volumes (with what posing it takes) and of a pair of
  /// triangles, from least squares over replays of all volumes; of a first look with margins and of
  /// a first batch of triangles, from pairs of bodies by themselves. Spheres cost two thirds of
  /// this, rectangle swept spheres half as much again, in each of the three ways; only what they
  /// cost beside each other matters here.
  struct Prices {
    double run, volumes, triangles, look, batch;
  };
  static constexpr Prices broad{25, 14, 20, 0, 0}, plain{25, 18, 30, 0, 120},
      careful{25, 28, 120, 75, 0};
  /// Of posing the roots of two bodies, from unit costs (record cost-model): to make a pose ready
  /// for volumes takes 36, a volume 11, the mean of eight kinds.
  static constexpr double roots_posed = 2 * (36 + 11);

  template <class Pair>
  void run(const Pair& pair) {
    if (watched_ && margins_.quiet(pair)) return void(++unseen_);
    if (use_ == Use::margins) return run_margins(pair);
    if (use_ == Use::roots && balls_apart(pair)) return;
    if (same_as_before(pair)) return;
    follow(pair);
    if (use_ == Use::roots && !list_is_due()) return run_roots(pair, Start::roots);
    run_list(pair);
  }

  /// Roots are tested as a batch where balls have not been apart lately.
  bool starts_at_roots() const { return in_batches_ && !list_is_due(); }
  void roots_are_apart() {
    known_ = false;
    ++unseen_;
    owed_ -= broad.run + broad.volumes;
    if (--until_look_ <= 0) in_batches_ = false;
  }
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    if (same_as_before(pair)) return;
    follow(pair);
    if (!list_is_due()) return run_roots(pair, Start::below_roots);
    run_list(pair);
  }

  std::size_t front_size() const {
    return use_ == Use::list ? list_.size() : use_ == Use::margins ? margins_.front_size() : 0;
  }

 private:
  enum class Use : std::uint8_t { roots, list, margins };

  /// What recursion over both nodes costs beside a rebuild, by these prices: fewer tests in larger
  /// batches, and no front to write.
  static constexpr double both_over_rebuild = 0.85;
  /// Motion from frame to frame in sizes of leaves. Above `jump` nothing of a front survives and
  /// lists are not tried (record of coherence). Margins are tried below `small`: gaps are some half
  /// of a leaf wide, so that an entry comes up in 2m of the runs after steps of m leaves, and with
  /// two triangles to three volumes costs some three times what it costs a list: that pays up to
  /// m = 0.15.
  static constexpr double jump = 4, small = 0.15;
  /// Of the entries that could come up, so many do: bodies that wander come back, and half of what
  /// they pass they leave behind.
  static constexpr double toward = 0.5;
  /// Chosen, as are `patience` and `look_every`: more is lost in vain, less gives up too early.
  static constexpr double recursions_to_lose = 3;
  /// At all entries of a front with margins: that of a rebuild, which is no loss if it lasts, and
  /// one more. Chosen, too.
  static constexpr double looks_to_lose = 2;
  /// What is tried in vain, and the rebuild of a list of bodies that part, which stays long without
  /// growing, may cost one part in so many.
  static constexpr double patience = 32;
  static constexpr std::size_t room = 16;  // entries for each node, at most (see by_cost.hpp)
  /// Whether the query is answered by yes or no, and a hit settles it.
  template <class Query>
  static constexpr bool yes_or_no =
      !wants_bound<Query>() && Query::one_hit_is_enough && requires(const Query& query) {
    { query.answer() } -> std::same_as<bool>;
  };
  static constexpr int look_every = 8;  // runs of which the roots are tested as a batch

  static double price(const TraversalStatistics& statistics, const Prices& prices) {
    return prices.run + prices.volumes * static_cast<double>(statistics.volumes) +
           prices.triangles * static_cast<double>(statistics.triangles) +
           (statistics.volumes + statistics.triangles > 0 ? prices.look : 0) +
           (statistics.triangles > 0 ? prices.batch : 0);
  }

  /// Of a surface of so many leaves about as wide as long.
  static double leaf_size(const HierarchyExtent& extent) {
    return 2 * extent.radius / std::sqrt(static_cast<double>(extent.nodes + 1) / 2);
  }

  /// Whether the balls about the two frames' origins are farther apart than the query asks. What is
  /// added to the radii is far more than what rotations may be off and rounding can do.
  template <class Pair>
  bool balls_apart(const Pair& pair) {
    if (until_look_ > 0) return --until_look_, false;
    if (balls_ == 0)
      balls_ = (ball(pair.a().extent()) + ball(pair.b().extent())) * (1 + 0x1p-20) +
               (pair.a().extent().reach + pair.b().extent().reach) * 0x1p-40;
    const Vec3<double>&a = pair.a().pose().translation, &b = pair.b().pose().translation;
    const double radii = balls_ + (a.lpNorm<1>() + b.lpNorm<1>()) * 0x1p-40 + pair.query().limit();
    const double squared = (a - b).squaredNorm();
    in_batches_ = !(squared > radii * radii) || !(squared > tiny);
    if (!in_batches_) return ++unseen_, true;
    until_look_ = look_every;
    return false;
  }
  /// Of one about the frame's origin that holds the mesh. Volumes may reach much farther.
  static double ball(const HierarchyExtent& extent) {
    return std::min(extent.reach, stable_norm(extent.centre) + extent.radius);
  }
  static constexpr double tiny = 0x1p-900;  // squares below are not to be trusted

  /// Answers where nothing has moved since an answer that can be repeated.
  template <class Pair>
  bool same_as_before(const Pair& pair) {
    using Query = typename Pair::Query;
    const std::uint32_t a = pair.a().epoch(), b = pair.b().epoch();
    const bool same = known_ && a == epoch_a_ && b == epoch_b_ && asked_ == &Query::name;
    if constexpr (requires { pair.query().distance(); }) {
      if (same) pair.query().stays(distance_);
    } else if constexpr (yes_or_no<Query>) {
      if (same && touching_) pair.query().known(0, 0);  // which triangles is no part of a yes
    }
    epoch_a_ = a, epoch_b_ = b;
    asked_ = &Query::name;
    return same;
  }

  /// Remembers the answer if it is yes or no, or a number, or that nothing was found.
  template <class Pair>
  void remember(const Pair& pair, const TraversalStatistics& statistics) {
    auto& query = pair.query();
    if constexpr (requires { query.distance(); })
      known_ = true, distance_ = query.distance();
    else if constexpr (yes_or_no<typename Pair::Query>)
      known_ = true, touching_ = query.answer();
    else
      known_ = statistics.everything && statistics.triangles == 0;
  }

  /// Finds the last step of the bodies; one so large that nothing is where it was ends what is in
  /// use. That costs as much as some tests, so where margins do not ask for it anyway only two
  /// successive runs of eight do: the same for all pairs of bodies that move together.
  template <class Pair>
  void follow(const Pair& pair) {
    MovingBody &a = pair.a(), &b = pair.b();
    constexpr std::uint32_t cycle = 16, looks = 4;  // in moves of both bodies, which begin at 2
    if (!watched_ && (a.epoch() + b.epoch() - 2) % cycle >= looks && leaf_ > 0) {
      ++unseen_;
      return;
    }
    const double displacement = a.displacement_bound() + b.displacement_bound();
    if (leaf_ == 0) {
      leaf_ = (leaf_size(a.extent()) + leaf_size(b.extent())) / 2;
      // Not less than a mean of both bodies' moves, some of which are net of several.
      step_ =
          std::max(leaf_, a.displacement_bound() / a.epoch() + b.displacement_bound() / b.epoch());
    } else if ((watched_ || unseen_ == 0) && displacement != displacement_) {
      step_ = (displacement - displacement_) / (1 + unseen_);
    }
    displacement_ = displacement;
    unseen_ = 0;
    if (use_ != Use::roots && jumped()) fail_list();
  }
  bool jumped() const { return step_ > jump * leaf_; }

  /// Whether what failed is to be tried again.
  bool is_due() const { return owed_ <= 0 || step_ < failed_at_ / 2; }
  bool list_is_due() const { return is_due() && !jumped(); }
  void failed(double lost) {
    owed_ = patience * lost;
    failed_at_ = step_;
  }

  template <class Pair>
  void run_roots(const Pair& pair, Start start) {
    const TraversalStatistics statistics = pair.template from_roots<NoFrontBoth>(start);
    remember(pair, statistics);
    owed_ -= price(statistics, broad);
  }

  template <class Pair>
  void run_list(const Pair& pair) {
    if (use_ == Use::roots) {
      use_ = Use::list;
      in_batches_ = false;
      worn_out_ = true;
      balance_ = spent_ = runs_ = owed_ = failed_at_ = 0;
    } else if (everything_) {
      if (margins_are_due()) return try_margins(pair);
    } else if (witness_lasts(pair)) {
      return;
    }
    if (watched_) forget_margins();
    const bool rebuild = worn_out_;
    if (rebuild) list_.restart();
    const TraversalStatistics statistics = pair.from_front(list_);
    remember(pair, statistics);
    everything_ = statistics.everything;
    if (list_.size() == 1 && !margins_are_due()) return part();
    // After a rebuild: all entries, or the witness that is found again.
    next_run_ = !rebuild                ? price(statistics, plain)
                : statistics.everything ? price({true, list_.size(), statistics.triangles}, plain)
                                        : price({false, 1, 1}, plain);
    account_list(price(statistics, plain), rebuild);
    const std::size_t longest = room * (pair.a().extent().nodes + pair.b().extent().nodes);
    worn_out_ = worn_out_ || list_.size() > longest;
  }

  /// Whether the witness is one still: with a margin of its own, unless bodies are fast.
  template <class Pair>
  bool witness_lasts(const Pair& pair) {
    if constexpr (yes_or_no<typename Pair::Query>) {
      TraversalStatistics statistics;
      if (watched_) {
        statistics = margins_.look_as_it_is(pair);
      } else {
        watched_ = true;
        margins_.start_from(list_, 1, pair.a(), pair.b(), step_);
        margins_.expect(!is_slow());
        statistics = margins_.run(pair);
      }
      spend(price(statistics, plain));
      if (!pair.query().answer()) return false;
      return known_ = touching_ = true;
    }
    return false;
  }

  void forget_margins() {
    margins_.forget();
    watched_ = false;
  }

  /// By the rule of by_cost.hpp, triangles included, and against recursion.
  void account_list(double cost, bool rebuild) {
    if (rebuild) {
      // What the runs since the last one would have cost from the roots.
      const double recursion = both_over_rebuild * (rebuild_ + cost) / 2;
      rebuild_ = cost;
      balance_ = std::max(balance_ + spent_ - runs_ * recursion, -recursions_to_lose * cost);
      if (balance_ > recursions_to_lose * cost) return fail_list();
      spent_ = runs_ = 0;
      swept_ = 0;
    }
    spend(cost);
    swept_ += everything_;
    worn_out_ = runs_ > 1 && (cost * runs_ > spent_ || swept_ >= patience);
  }

  void spend(double cost) {
    owed_ -= cost;
    spent_ += cost;
    ++runs_;
  }

  /// The roots are apart: there is no list to keep, and none has failed.
  void part() {
    use_ = Use::roots;
    forget_margins();
    until_look_ = 0;
  }

  void fail_list() {
    list_.clear();
    forget_margins();
    use_ = Use::roots;
    until_look_ = 0;
    known_ = false;
    failed(recursions_to_lose * rebuild_);
  }

  bool margins_are_due() const { return is_due() && (is_slow() || list_.size() == 1); }
  bool is_slow() const { return step_ < small * leaf_; }

  template <class Pair>
  void try_margins(const Pair& pair) {
    margins_.start_from(list_, list_.size(), pair.a(), pair.b(), step_);
    const TraversalStatistics statistics = margins_.run(pair);
    known_ = false;
    const double cost = price(statistics, careful) - careful.run;
    // Roots that need not be posed are what one margin saves.
    const double posed = list_.size() == 1 ? roots_posed : 0;
    const double expected = careful.run + toward * (cost + posed) * margins_.due_in_a_run(step_);
    const double otherwise = list_.size() == 1 ? broad.run + broad.volumes + posed : next_run_;
    if (expected > otherwise) {
      failed(cost);
      forget_margins();
      if (list_.size() == 1) part();
      return;
    }
    use_ = Use::margins;
    watched_ = true;
    entry_ = (next_run_ - plain.run) / static_cast<double>(list_.size());
    balance_ = 0;
    enough_ = cost;
    list_.clear();
  }

  template <class Pair>
  void run_margins(const Pair& pair) {
    const int quiet = unseen_;
    follow(pair);
    if (use_ != Use::margins) return run(pair);
    const std::uint32_t rebuilds = margins_.rebuilds();
    const TraversalStatistics statistics = margins_.look(pair);
    const double cost = price(statistics, careful);
    const auto entries = static_cast<double>(margins_.front_size());
    // What it takes to come back is enough to be lost, or to be had in hand.
    if (margins_.rebuilds() != rebuilds) {
      if (statistics.everything)
        entry_ = (price(statistics, plain) - plain.run) / (2 * entries - 1);
      enough_ = cost;
    }
    if (statistics.volumes + statistics.triangles > 0) {
      next_run_ =
          statistics.everything ? plain.run + entry_ * entries : price({false, 1, 1}, plain);
      enough_ = std::max(enough_, cost);
    }
    balance_ = std::max(balance_ + cost + quiet * careful.run - (1 + quiet) * next_run_, -enough_);
    if (balance_ > looks_to_lose * enough_) give_back();
  }

  /// A list goes on with the entries of the margins, as if it had just been rebuilt.
  void give_back() {
    list_.restart_from(margins_.front());
    forget_margins();
    failed(2 * enough_);
    use_ = Use::list;
    known_ = worn_out_ = false;
    everything_ = true;
    spent_ = 2 * next_run_;
    runs_ = 1;
    swept_ = 0;
    balance_ = 0;
  }

  // What is looked at in every run stands together.
  Use use_ = Use::roots;
  bool in_batches_ = false;
  bool known_ = false, touching_ = false;  // the answer, while nothing moves
  bool watched_ = false;                   // there are margins, of all or of the witness
  bool worn_out_ = false;                  // the list is
  bool everything_ = true;                 // seen by the list's last run
  int until_look_ = 0;                     // runs before balls are looked at
  int unseen_ = 0;                         // runs since the bodies were followed
  int swept_ = 0;                          // runs through all of the list since its rebuild
  double owed_ = 0, failed_at_ = 0;        // before what failed is tried again; step
  std::uint32_t epoch_a_ = 0, epoch_b_ = 0;
  const std::string_view* asked_ = nullptr;
  double displacement_ = 0, step_ = 0;          // of both bodies; in the last run
  double balls_ = 0;                            // the radii of both, together
  double leaf_ = 0;                             // size of one, mean of both bodies
  double rebuild_ = 0;                          // what the list's last one cost
  double balance_ = 0;                          // what was lost against the other way
  double spent_ = 0, runs_ = 0, next_run_ = 0;  // of the list, since its rebuild; expected
  double entry_ = 0;   // what a run of a list would cost, for each entry of the margins
  double enough_ = 0;  // that margins may lose, or have in hand
  double distance_ = 0;
  Front list_;
  Margins margins_;
};

}  // namespace bvlab
