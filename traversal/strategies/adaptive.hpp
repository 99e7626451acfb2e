// SPDX-License-Identifier: BSD-3-Clause
/// Recursion (both nodes of a pair descended at once), a list or margins, whichever is cheapest for
/// this pair.
///
/// Costs are counted, not timed, so that runs repeat: pairs of volumes and of triangles tested,
/// each at what it costs in that way (`Prices`). What the others would cost is mostly known without
/// trying them:
///
/// - A rebuild of a list is a recursion. So a list keeps a balance of what its runs cost over what
///   recursion has cost lately, and gives up when it has lost three recursions. It is tried again
///   after 8 runs near each other, then 32, 128, ..., and at once when the step has halved: each
///   failure costs at most some five recursions, so they add up to O(log(runs)) of them.
/// - Margins start from a list's entries, which takes one test of each, not from the roots. The
///   gaps found say how often each entry is going to come up, so one run is enough to judge by: a
///   trial in vain costs about two runs of the list, and those are spaced alike.
/// - Margins know how long a list would be. They keep a balance, too, and hand their entries back
///   to a list when they have lost what it takes to come back.
///
/// A pair of which no body has moved is not asked again, and bodies whose balls are apart are told
/// by their translations alone.
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
  /// triangles: least squares over replays of all volumes, rounded to what holds for most. With
  /// spheres a test of volumes costs two thirds of this, with rectangle swept spheres half as much
  /// again, in each of the three ways; only what they cost beside each other matters here.
  struct Prices {
    double run, volumes, triangles;
  };
  static constexpr Prices broad{25, 14, 20}, plain{25, 18, 30}, careful{25, 28, 150};

  template <class Pair>
  void run(const Pair& pair) {
    if (use_ == Use::margins) return run_margins(pair);
    if (use_ == Use::roots && balls_apart(pair)) return;
    if (same_as_before(pair)) return;
    follow(pair);
    if (use_ == Use::roots && !list_is_due()) return run_roots(pair, Start::roots);
    run_list(pair);
  }

  /// Roots are tested as a batch where balls have not been apart lately.
  bool starts_at_roots() const { return in_batches_; }
  void roots_are_apart() {
    known_ = false;
    ++unseen_;
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

  struct List : Front {
    void restart_from(const MarginFront& front) {
      entries_ = front.entries();
      witnessed_ = false;
      if (front.witnessed()) bring_forward(front.witness());
    }
  };

  /// What recursion over both nodes costs beside a rebuild, by these prices: fewer tests in larger
  /// batches, and no front to write.
  static constexpr double both_over_rebuild = 0.85;
  /// Motion from frame to frame in sizes of leaves. Above `jump` nothing of a front survives and
  /// lists are not tried (record of coherence). Margins are tried below `small`: gaps are some half
  /// of a leaf wide, so that an entry comes up in 2m of the runs after steps of m leaves, and with
  /// two triangles to three volumes costs 3.4 times what it costs a list: that pays up to m = 0.15.
  static constexpr double jump = 4, small = 0.125;
  /// Of the entries that could come up, so many do: bodies that wander come back, and half of what
  /// they pass they leave behind.
  static constexpr double toward = 0.5;
  static constexpr double recursions_to_lose = 3;
  static constexpr int first_wait = 8, longest_wait = 1 << 14, wait_growth = 4;
  /// A list of bodies that part stays long without growing, and so is rebuilt after so many runs
  /// through all of it: where that was in vain it has cost a thirty-second part.
  static constexpr int oldest = 32;
  static constexpr std::size_t room = 16;  // entries for each node, at most (see by_cost.hpp)
  static constexpr int look_every = 8;     // runs of which the roots are tested as a batch

  static double price(const TraversalStatistics& statistics, const Prices& prices) {
    return prices.run + prices.volumes * static_cast<double>(statistics.volumes) +
           prices.triangles * static_cast<double>(statistics.triangles);
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
    const Vec3<double>&a = pair.a().pose().translation, &b = pair.b().pose().translation;
    const double radii = (pair.a().extent().reach + pair.b().extent().reach) * (1 + 0x1p-20) +
                         (a.lpNorm<1>() + b.lpNorm<1>()) * 0x1p-40 + pair.query().limit();
    const double squared = (a - b).squaredNorm();
    in_batches_ = !(squared > radii * radii) || !(squared > tiny);
    if (!in_batches_) return ++unseen_, true;
    until_look_ = look_every;
    return false;
  }
  static constexpr double tiny = 0x1p-900;  // squares below are not to be trusted

  /// Answers where nothing has moved since an answer that can be repeated.
  template <class Pair>
  bool same_as_before(const Pair& pair) {
    using Query = typename Pair::Query;
    const std::uint32_t a = pair.a().epoch(), b = pair.b().epoch();
    const bool same = known_ && a == epoch_a_ && b == epoch_b_ && asked_ == &Query::name;
    if constexpr (requires { pair.query().distance(); })
      if (same) pair.query().stays(distance_);
    epoch_a_ = a, epoch_b_ = b;
    asked_ = &Query::name;
    return same;
  }

  /// Remembers the answer if it is that nothing was found, or a number.
  template <class Pair>
  void remember(const Pair& pair, const TraversalStatistics& statistics) {
    auto& query = pair.query();
    if constexpr (requires { query.distance(); })
      known_ = true, distance_ = query.distance();
    else if constexpr (requires {
                         { query.answer() } -> std::same_as<bool>;
                       })
      known_ = !query.answer();
    else
      known_ = statistics.everything && statistics.triangles == 0;
  }

  /// Finds the last step of the bodies; one so large that nothing is where it was ends what is in
  /// use.
  template <class Pair>
  void follow(const Pair& pair) {
    MovingBody &a = pair.a(), &b = pair.b();
    const double displacement = a.displacement_bound() + b.displacement_bound();
    if (displacement_ < 0)
      leaf_ = (leaf_size(a.extent()) + leaf_size(b.extent())) / 2;
    else if (displacement != displacement_)
      step_ = (displacement - displacement_) / (1 + unseen_);
    displacement_ = displacement;
    unseen_ = 0;
    if (use_ != Use::roots && jumped()) fail_list();
  }
  bool jumped() const { return step_ > jump * leaf_; }

  bool list_is_due() const { return until_list_ <= 0 && !jumped(); }

  template <class Pair>
  void run_roots(const Pair& pair, Start start) {
    const TraversalStatistics statistics = pair.template from_roots<NoFrontBoth>(start);
    remember(pair, statistics);
    learn_recursion(price(statistics, broad));
    until_list_ = step_ < list_failed_at_ / 2 ? 0 : until_list_ - (until_list_ > 0);
  }

  void learn_recursion(double cost) {
    recursion_ = recursion_ < 0 ? cost : (recursion_ + cost) / 2;
  }

  template <class Pair>
  void run_list(const Pair& pair) {
    if (use_ == Use::roots) {
      use_ = Use::list;
      in_batches_ = false;
      worn_out_ = true;
      balance_ = 0;
    } else if (margins_are_due()) {
      return try_margins(pair);
    }
    const bool rebuild = worn_out_;
    if (rebuild) list_.restart();
    const TraversalStatistics statistics = pair.from_front(list_);
    remember(pair, statistics);
    if (list_.size() == 1 && !is_slow()) return part();
    const std::size_t longest = room * (pair.a().extent().nodes + pair.b().extent().nodes);
    account_list(price(statistics, plain), rebuild);
    swept_ += statistics.everything;
    worn_out_ = worn_out_ || list_.size() > longest;
    if (rebuild) expect_next(statistics);
  }

  /// After a rebuild: all entries, or the witness that is found again.
  void expect_next(const TraversalStatistics& rebuild) {
    next_run_ = rebuild.everything ? price({true, list_.size(), rebuild.triangles}, plain)
                                   : price({false, 1, 1}, plain);
  }

  /// By the rule of by_cost.hpp, triangles included, and against recursion.
  void account_list(double cost, bool rebuild) {
    if (rebuild) {
      learn_recursion(both_over_rebuild * cost);
      spent_ = runs_ = 0;
      swept_ = 0;
    }
    spent_ += cost;
    ++runs_;
    worn_out_ = runs_ > 1 && (cost * runs_ > spent_ || swept_ >= oldest);
    balance_ = std::max(balance_ + cost - recursion_, -recursions_to_lose * recursion_);
    if (balance_ > recursions_to_lose * recursion_)
      fail_list();
    else if (worn_out_)
      list_wait_ = first_wait;
  }

  /// The roots are apart: there is no list to keep, and none has failed. Not where so little moves
  /// that margins know it without a look.
  void part() {
    use_ = Use::roots;
    until_look_ = 0;
  }

  void fail_list() {
    list_.clear();
    margins_.forget();
    use_ = Use::roots;
    until_look_ = 0;
    known_ = false;
    list_failed_at_ = step_;
    until_list_ = list_wait_;
    list_wait_ = std::min(wait_growth * list_wait_, longest_wait);
  }

  bool margins_are_due() {
    if (step_ < margins_failed_at_ / 2) return true;
    if (until_margins_ > 0) return --until_margins_, false;
    return is_slow();
  }
  bool is_slow() const { return step_ < small * leaf_; }

  template <class Pair>
  void try_margins(const Pair& pair) {
    margins_.start_from(list_, pair.a(), pair.b(), step_);
    const TraversalStatistics statistics = margins_.run(pair);
    known_ = false;
    const double cost = price(statistics, careful) - careful.run;
    const double expected = careful.run + toward * cost * margins_.due_in_a_run(step_);
    const double list_run = runs_ > 1 ? spent_ / runs_ : next_run_;
    if (expected > list_run) {
      delay_margins();
      return margins_.forget();
    }
    use_ = Use::margins;
    margins_wait_ = first_wait;
    margins_failed_at_ = 0;
    list_an_entry_ = list_run / static_cast<double>(margins_.front_size());
    balance_ = 0;
    list_.clear();
  }

  void delay_margins() {
    until_margins_ = margins_wait_;
    margins_wait_ = std::min(wait_growth * margins_wait_, longest_wait);
    margins_failed_at_ = step_;
  }

  template <class Pair>
  void run_margins(const Pair& pair) {
    follow(pair);
    if (use_ != Use::margins) return run(pair);
    const std::uint32_t rebuilds = margins_.rebuilds();
    const TraversalStatistics statistics = margins_.run(pair);
    const double cost = price(statistics, careful);
    const auto entries = static_cast<double>(margins_.front_size());
    if (margins_.rebuilds() != rebuilds) list_an_entry_ = price(statistics, plain) / 2 / entries;
    // What it takes to come back is enough to be lost, or to be had in hand.
    const double list_run = list_an_entry_ * entries, enough = careful.volumes * entries;
    balance_ = std::max(balance_ + cost - list_run, -enough);
    if (balance_ > enough) give_back(list_run);
  }

  /// A list goes on with the entries of the margins, as if it had just been rebuilt.
  void give_back(double list_run) {
    list_.restart_from(margins_.front());
    margins_.forget();
    delay_margins();
    use_ = Use::list;
    known_ = worn_out_ = false;
    spent_ = 2 * list_run;
    runs_ = 1;
    swept_ = 0;
    next_run_ = list_run;
    balance_ = 0;
  }

  // What is looked at in every run stands together.
  Use use_ = Use::roots;
  bool in_batches_ = false;
  bool known_ = false;                      // the answer, while nothing moves
  bool worn_out_ = false;                   // the list is
  int until_look_ = 0;                      // runs before balls are looked at
  int unseen_ = 0;                          // runs since the bodies were followed
  int swept_ = 0;                           // runs through all of the list since its rebuild
  int until_list_ = 0, until_margins_ = 0;  // runs before they are tried
  std::uint32_t epoch_a_ = 0, epoch_b_ = 0;
  const std::string_view* asked_ = nullptr;
  double displacement_ = -1, step_ = 0;         // of both bodies; in the last run
  double leaf_ = 0;                             // size of one, mean of both bodies
  double recursion_ = -1;                       // what it costs, lately
  double balance_ = 0;                          // what was lost against the other way
  double spent_ = 0, runs_ = 0, next_run_ = 0;  // of the list, since its rebuild; expected
  double list_an_entry_ = 0;  // what a run of a list would cost, for each entry of the margins
  double list_failed_at_ = 0, margins_failed_at_ = 0;  // steps
  int list_wait_ = first_wait, margins_wait_ = first_wait;
  double distance_ = 0;
  List list_;
  Margins margins_;
};

}  // namespace bvlab
