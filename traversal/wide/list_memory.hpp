// SPDX-License-Identifier: BSD-3-Clause
/// The memory of lists: each pair of bodies keeps a witness and a front whose closed lanes are all
/// retested in the next run. See no_memory.hpp for the members.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string_view>
#include <vector>

#include "traversal/strategies/rebuild_rule.hpp"
#include "traversal/wide/no_memory.hpp"

namespace bvlab {

class ListMemory : public NoMemory {
 public:
  static constexpr std::string_view name = "separation-list";
  template <class S>
  using Record = FrontRecord<S, Keeps::list>;

  /// Whether entries are closed again where the bodies have come apart.
  enum class Raise { never, tried };
  explicit ListMemory(RebuildRule rule = RebuildRule::after_still_runs(0),
                      Raise raise = Raise::never)
      : NoMemory(Witness::kept), rule_(rule), raise_(raise) {}

  void add_body(const HierarchyExtent& extent) {
    NoMemory::add_body(extent);
    nodes_.push_back(extent.nodes);
  }
  void resize(std::size_t pairs) { NoMemory::resize(pairs), lists_.resize(pairs, {{}, rule_}); }
  void forget(std::size_t p) { NoMemory::forget(p), lists_[p] = {{}, rule_}; }
  template <class Query>
  void begin_frame() {
    if (NoMemory::begin_frame<Query>()) std::fill(lists_.begin(), lists_.end(), List{{}, rule_});
  }
  std::size_t front_size(std::size_t p) const { return lists_[p].front.size(); }
  std::size_t front_size() const {
    return std::accumulate(
        lists_.begin(), lists_.end(), std::size_t{0},
        [](std::size_t sum, const List& list) { return sum + list.front.size(); });
  }

  template <class Query>
  TraversalStart start(std::size_t p, const ObjectPair& pair) {
    TraversalStart start = NoMemory::start<Query>(p, pair);
    List& list = lists_[p];
    if (list.rule.due(list.front.size(), 16 * (nodes_[pair.i] + nodes_[pair.j])))
      list.front.clear();
    if (!list.front.is_complete()) list.rule.restart();
    start.front = &list.front, start.rises = raise_ == Raise::tried;
    return start;
  }
  template <class Query, class Record>
  void remember(std::size_t p, const ObjectPair& pair, const Query& query, const Record& found) {
    NoMemory::remember(p, pair, query, found);
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
