// SPDX-License-Identifier: BSD-3-Clause
/// Memories of lists: each pair of bodies keeps a front whose closed lanes are all retested in the
/// next run (ListMemory); or the two leaves alone that decided the last run (WitnessMemory). See
/// no_memory.hpp for the members.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string_view>
#include <vector>

#include "traversal/strategies/rebuild_rule.hpp"
#include "traversal/wide/no_memory.hpp"

namespace bvlab {

class WitnessMemory : public NoMemory {
 public:
  static constexpr std::string_view name = "witness";

  void resize(std::size_t pairs) { NoMemory::resize(pairs), witnesses_.resize(pairs); }
  void forget(std::size_t p) { witnesses_[p].reset(); }
  /// Another query than in the last frame starts without a witness.
  template <class Query>
  bool begin_frame() {
    if (last_query_ == &Query::name) return false;
    last_query_ = &Query::name;
    std::fill(witnesses_.begin(), witnesses_.end(), std::nullopt);
    return true;
  }
  template <class Query>
  TraversalStart start(std::size_t p, const ObjectPair& pair) const {
    TraversalStart start = NoMemory::start<Query>(p, pair);
    if constexpr (!FindsAllHits<Query>) start.witness = witnesses_[p];
    return start;
  }
  template <class Query, class Record>
  void remember(std::size_t p, const ObjectPair& pair, const Query& query, const Record& found) {
    NoMemory::remember(p, pair, query, found);
    if (found.touched()) witnesses_[p] = found.touched();
  }

 private:
  std::vector<std::optional<NodePair>> witnesses_;
  const std::string_view* last_query_ = nullptr;
};

class ListMemory : public WitnessMemory {
 public:
  static constexpr std::string_view name = "separation-list";
  template <class S>
  using Record = FrontRecord<S, Keeps::list>;

  /// Whether entries are closed again where the bodies have come apart.
  enum class Raise { never, tried };
  explicit ListMemory(RebuildRule rule = RebuildRule::after_still_runs(0),
                      Raise raise = Raise::never)
      : rule_(rule), raise_(raise) {}

  void add_body(const HierarchyExtent& extent) {
    NoMemory::add_body(extent);
    nodes_.push_back(extent.nodes);
  }
  void resize(std::size_t pairs) { WitnessMemory::resize(pairs), lists_.resize(pairs, {{}, rule_}); }
  void forget(std::size_t p) { WitnessMemory::forget(p), lists_[p] = {{}, rule_}; }
  template <class Query>
  void begin_frame() {
    if (WitnessMemory::begin_frame<Query>())
      std::fill(lists_.begin(), lists_.end(), List{{}, rule_});
  }
  std::size_t front_size(std::size_t p) const { return lists_[p].front.size(); }
  std::size_t front_size() const {
    return std::accumulate(
        lists_.begin(), lists_.end(), std::size_t{0},
        [](std::size_t sum, const List& list) { return sum + list.front.size(); });
  }

  template <class Query>
  TraversalStart start(std::size_t p, const ObjectPair& pair) {
    TraversalStart start = WitnessMemory::start<Query>(p, pair);
    List& list = lists_[p];
    if (list.rule.due(list.front.size(), 16 * (nodes_[pair.i] + nodes_[pair.j])))
      list.front.clear();
    if (!list.front.is_complete()) list.rule.restart();
    start.front = &list.front, start.rises = raise_ == Raise::tried;
    return start;
  }
  template <class Query, class Record>
  void remember(std::size_t p, const ObjectPair& pair, const Query& query, const Record& found) {
    WitnessMemory::remember(p, pair, query, found);
    List& list = lists_[p];
    if (!found.sweeps()) list.front.complete();
    list.front.close_up();
    list.rule.ran(found.grew(), found.tests());
  }

 private:
  struct List {
    WideFront front;
    RebuildRule rule;
  };
  RebuildRule rule_;
  Raise raise_;
  std::vector<std::size_t> nodes_;  // of each body's tree
  std::vector<List> lists_;
};

}  // namespace bvlab
