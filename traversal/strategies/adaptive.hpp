// SPDX-License-Identifier: BSD-3-Clause
/// Chooses per pair what is expected to be cheapest: recursion (descending both nodes of a pair at
/// once), a separation list, or margins.
///
/// Costs are counted, not timed, so that runs repeat: volume tests and triangle tests, each at a
/// price that depends on which of the three is in use (adaptive_prices.hpp). A list and margins
/// keep a balance: their cost minus that of the alternative. A list is given up when it has lost as
/// much as three rebuilds cost; margins, when they have lost two tests of all entries. Either is
/// tried again once 32 times its last loss has been spent, or when the step has halved, so failed
/// trials add about a thirty-second. What the alternatives would cost is mostly known without a
/// trial:
///
/// - A rebuild of a list costs what a recursion costs.
/// - Margins start from a list's entries, at one test each, not from the roots. The gaps found
///   predict how often each entry is due. The length of a list is known from the margins.
/// - Where a hit settles the query, a list with its witness serves as both. The triangles of the
///   witness are tested first, with a margin where bodies are slow, and no volume is posed while
///   they still touch.
///
/// At rest, yes or no and distances are repeated, and contacts are kept by margins, whatever the
/// step was before (observed_step.hpp). A pair whose spheres are apart is decided by the
/// translations alone, and one whose roots are apart by one margin; neither is posed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "traversal/front.hpp"
#include "traversal/no_front.hpp"
#include "traversal/strategies/adaptive_prices.hpp"
#include "traversal/strategies/last_answer.hpp"
#include "traversal/strategies/margins.hpp"
#include "traversal/strategies/observed_step.hpp"
#include "traversal/strategies/sphere_test.hpp"

namespace bvlab {

class Adaptive : public AdaptivePrices {
 public:
  static constexpr std::string_view name = "adaptive";
  static constexpr std::string_view description =
      "recursion, a list or margins, whichever is expected to be cheapest";

  template <class Pair>
  void run(const Pair& pair) {
    if (has_margins_ && margins_.quiet(pair)) return step_.skip();
    if (use_ == Use::margins) return run_margins(pair);
    if (use_ == Use::roots && spheres_apart(pair)) return;
    if (answer_.repeat(pair)) return;
    follow(pair);
    if (use_ == Use::roots && !list_is_due()) return run_roots(pair, Start::roots);
    run_list(pair);
  }

  /// Roots are tested in batches for pairs whose spheres were not apart lately.
  bool starts_at_roots() const { return in_batches_ && !list_is_due(); }
  void roots_are_apart() {
    answer_.forget();
    step_.skip();
    cost_before_retry_ -= of_recursion.run + of_recursion.volumes;
    if (spheres_.batch_is_over()) in_batches_ = false;
  }
  template <class Pair>
  void run_below_roots(const Pair& pair) {
    if (answer_.repeat(pair)) return;
    follow(pair);
    if (!list_is_due()) return run_roots(pair, Start::below_roots);
    run_list(pair);
  }

  std::size_t front_size() const {
    return use_ == Use::list ? list_.size() : use_ == Use::margins ? margins_.front_size() : 0;
  }

 private:
  enum class Use : std::uint8_t { roots, list, margins };

  template <class Pair>
  bool spheres_apart(const Pair& pair) {
    const SphereTest::Result seen = spheres_(pair);
    if (seen == SphereTest::Result::not_tested) return false;
    pair.count_bodies();
    in_batches_ = seen == SphereTest::Result::near;
    if (!in_batches_) step_.skip();
    return !in_batches_;
  }

  /// Measures the step; where it is too far for anything to be reused, gives up the list.
  template <class Pair>
  void follow(const Pair& pair) {
    if (step_.measure(pair.a(), pair.b(), has_margins_) && use_ != Use::roots && jumped())
      fail_list();
  }
  bool jumped() const { return step_.expected_in_leaves() > jump; }

  bool is_due() const { return cost_before_retry_ <= 0 || step_.last() < failed_at_ / 2; }
  bool list_is_due() const { return is_due() && !jumped(); }
  void failed(double lost) { cost_before_retry_ = patience * lost, failed_at_ = step_.last(); }

  template <class Pair>
  void run_roots(const Pair& pair, Start start) {
    const TraversalStatistics statistics = pair.template from_roots<NoFrontBoth>(start);
    answer_.remember(pair, statistics);
    cost_before_retry_ -= price(statistics, of_recursion);
  }

  template <class Pair>
  void run_list(const Pair& pair) {
    if (use_ == Use::roots) {
      use_ = Use::list;
      in_batches_ = false;
      rebuild_due_ = true;
      balance_ = spent_ = runs_ = cost_before_retry_ = failed_at_ = 0;
    } else if (everything_) {
      if (margins_are_due()) return try_margins(pair);
    } else if (witness_lasts(pair)) {
      return;
    }
    if (has_margins_) forget_margins();
    const bool rebuild = rebuild_due_;
    if (rebuild) list_.restart();
    const TraversalStatistics statistics = pair.from_front(list_);
    answer_.remember(pair, statistics);
    everything_ = statistics.everything;
    if (list_.size() == 1 && !margins_are_due()) return part();
    // After a rebuild: the cost of all entries, or of the witness.
    next_run_ = !rebuild                ? price(statistics, of_list)
                : statistics.everything ? price({true, list_.size(), statistics.triangles}, of_list)
                                        : price({false, 1, 1}, of_list);
    account_list(price(statistics, of_list), rebuild);
    rebuild_due_ = rebuild_due_ || list_.size() > longest_list(pair);
  }

  /// Whether the witness still hits: by a margin of its own, unless the bodies are fast.
  template <class Pair>
  bool witness_lasts(const Pair& pair) {
    if constexpr (YesOrNoByOneHit<typename Pair::Query>) {
      TraversalStatistics statistics;
      if (has_margins_) {
        statistics = margins_.test_without_rebuild(pair);
      } else {
        has_margins_ = true;
        margins_.start_from(list_, 1, pair.a(), pair.b(), step_.expected());
        margins_.expect(!is_slow());
        statistics = margins_.run(pair);
      }
      spend(price(statistics, of_list));
      if (!pair.query().answer()) return false;
      answer_.remember_touching();
      return true;
    }
    return false;
  }

  void forget_margins() {
    margins_.forget();
    has_margins_ = false;
  }

  /// Applies the rule of by_cost.hpp, with triangles included, and compares with recursion.
  void account_list(double cost, bool rebuild) {
    if (rebuild) {
      // The cost that the runs since the last rebuild would have had from the roots.
      const double recursion = both_over_rebuild * (rebuild_ + cost) / 2;
      rebuild_ = cost;
      balance_ = std::max(balance_ + spent_ - runs_ * recursion, -rebuilds_to_lose * cost);
      if (balance_ > rebuilds_to_lose * cost) return fail_list();
      spent_ = runs_ = swept_ = 0;
    }
    spend(cost);
    swept_ += everything_;
    rebuild_due_ = runs_ > 1 && (cost * runs_ > spent_ || swept_ >= patience);
  }

  void spend(double cost) {
    cost_before_retry_ -= cost;
    spent_ += cost;
    ++runs_;
  }

  /// The roots are apart: there is no list to keep, which is not a failure of lists.
  void part() {
    use_ = Use::roots;
    forget_margins();
    spheres_.test_now();
  }

  void fail_list() {
    list_.clear();
    forget_margins();
    use_ = Use::roots;
    spheres_.test_now();
    answer_.forget();
    failed(rebuilds_to_lose * rebuild_);
  }

  bool margins_are_due() const { return is_due() && (is_slow() || list_.size() == 1); }
  bool is_slow() const { return step_.expected_in_leaves() < small; }

  template <class Pair>
  void try_margins(const Pair& pair) {
    margins_.start_from(list_, list_.size(), pair.a(), pair.b(), step_.expected());
    const TraversalStatistics statistics = margins_.run(pair);
    answer_.forget();
    const double cost = price(statistics, of_margins) - of_margins.run;
    // What one margin saves is posing the roots.
    const double posed = list_.size() == 1 ? roots_posed : 0;
    const double expected =
        of_margins.run + toward * (cost + posed) * margins_.due_in_a_run(step_.expected());
    const double otherwise =
        list_.size() == 1 ? of_recursion.run + of_recursion.volumes + posed : next_run_;
    if (expected > otherwise) {
      failed(cost);
      forget_margins();
      if (list_.size() == 1) part();
      return;
    }
    use_ = Use::margins;
    has_margins_ = true;
    list_cost_per_entry_ = (next_run_ - of_list.run) / static_cast<double>(list_.size());
    balance_ = 0;
    loss_limit_ = cost;
    list_.clear();
  }

  template <class Pair>
  void run_margins(const Pair& pair) {
    const int quiet = step_.skipped();
    follow(pair);
    if (use_ != Use::margins) return run(pair);
    const std::uint32_t rebuilds = margins_.rebuilds();
    const TraversalStatistics statistics = margins_.test_due(pair);
    const double cost = price(statistics, of_margins);
    const auto entries = static_cast<double>(margins_.front_size());
    // The cost of a return to margins is the most that they may lose, or hold as credit.
    if (margins_.rebuilds() != rebuilds) {
      if (statistics.everything)
        list_cost_per_entry_ = (price(statistics, of_list) - of_list.run) / (2 * entries - 1);
      loss_limit_ = cost;
    }
    if (statistics.volumes + statistics.triangles > 0) {
      // Not of what margins have opened: it would make a list look as dear as they are.
      const auto list_entries =
          static_cast<double>(std::max<std::size_t>(margins_.entries_of_list(), 1));
      next_run_ = statistics.everything ? of_list.run + list_cost_per_entry_ * list_entries
                                        : price({false, 1, 1}, of_list);
      loss_limit_ = std::max(loss_limit_, list_entries * of_margins.volumes);
    }
    balance_ =
        std::max(balance_ + cost + quiet * of_margins.run - (1 + quiet) * next_run_, -loss_limit_);
    if (balance_ > tests_to_lose * loss_limit_) give_back();
  }

  /// Continues with a list of the margins' entries, as if it had just been rebuilt.
  void give_back() {
    list_.restart_from(margins_.front());
    forget_margins();
    failed(2 * loss_limit_);
    use_ = Use::list;
    answer_.forget();
    rebuild_due_ = false, everything_ = true;
    spent_ = 2 * next_run_, runs_ = 1;
    swept_ = 0, balance_ = 0;
  }

  // Members that every run reads are next to each other.
  Use use_ = Use::roots;
  bool in_batches_ = false;
  bool has_margins_ = false;  // there are margins, of all entries or of the witness
  bool rebuild_due_ = false;  // the list is due for a rebuild
  bool everything_ = true;    // the list's last run was complete
  ObservedStep step_;
  int swept_ = 0;                                 // complete runs of the list since its rebuild
  double cost_before_retry_ = 0, failed_at_ = 0;  // to spend before the next trial; step at failure
  SphereTest spheres_;
  double rebuild_ = 0;                          // cost of the list's last rebuild
  double balance_ = 0;                          // cost of this way minus that of the other
  double spent_ = 0, runs_ = 0, next_run_ = 0;  // of the list, since its rebuild; next cost
  double list_cost_per_entry_ = 0;              // a list's cost per entry of the margins
  double loss_limit_ = 0;                       // the most that margins may lose, or hold as credit
  LastAnswer answer_;
  Front list_;
  Margins margins_;
};

}  // namespace bvlab
