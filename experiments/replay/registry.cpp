// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/registry.hpp"

#include <algorithm>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

std::string text_of(const std::vector<Named>& all) {
  std::string text;
  for (const auto& each : all) text += (text.empty() ? "" : ", ") + each.name;
  return text;
}

/// Those that were not named before, in order.
void add(std::vector<Named>& all, std::string_view name, std::string_view description) {
  const bool known =
      std::any_of(all.begin(), all.end(), [&](const Named& each) { return each.name == name; });
  if (!known) all.push_back({std::string(name), std::string(description)});
}

[[noreturn]] void refuse(const char* option, std::string_view name, const std::vector<Named>& all) {
  throw Unusable(std::string(option) + " " + std::string(name) + ": unknown; there are " +
                 text_of(all));
}

}  // namespace

std::vector<Named> volumes() {
  std::vector<Named> all;
  for (const auto* entry : volume_entries()) add(all, entry->name, entry->description);
  return all;
}

std::vector<Named> wide_volumes() {
  std::vector<Named> all;
  for (const auto* entry : wide_entries()) add(all, entry->volume, entry->volume_description);
  return all;
}

std::vector<Named> trees() {
  return {
      {"binary", "two children a node, which are posed into the world: any volume, any strategy"},
      {"wide", "up to " + std::to_string(wide_entries()[0]->fan_out) +
                   " children a node, tested at once in their mesh's own frame, the likeliest "
                   "first: --volume " +
                   text_of(wide_volumes()) + ", --strategy recursive or margins"}};
}

std::vector<Named> strategies() {
  std::vector<Named> all;
  for (const auto* entry : play_entries()) add(all, entry->strategy, entry->strategy_description);
  return all;
}

std::vector<Named> queries() {
  std::vector<Named> all;
  for (const auto* entry : play_entries()) add(all, entry->query, entry->query_description);
  return all;
}

const VolumeEntry& volume_entry(std::string_view name) {
  for (const auto* entry : volume_entries())
    if (entry->name == name) return *entry;
  std::string hint;
  for (const auto& each : wide_volumes()) {
    if (each.name == name)
      throw Unusable("--volume " + each.name +
                     ": in wide trees alone (--tree wide); in binary ones " + text_of(volumes()));
    hint += ", and with --tree wide " + each.name;
  }
  throw Unusable("--volume " + std::string(name) + ": unknown; there are " + text_of(volumes()) +
                 hint);
}

const WideEntry& wide_entry(std::string_view volume, std::string_view query) {
  bool volume_exists = false;
  for (const auto* entry : wide_entries()) {
    if (entry->volume != volume) continue;
    volume_exists = true;
    if (entry->query == query) return *entry;
  }
  if (!volume_exists)
    throw Unusable("--volume " + std::string(volume) + ": not in wide trees; there is " +
                   text_of(wide_volumes()));
  refuse("--query", query, queries());
}

const PlayEntry& play_entry(std::string_view strategy, std::string_view query) {
  bool strategy_exists = false;
  for (const auto* entry : play_entries()) {
    if (entry->strategy != strategy) continue;
    strategy_exists = true;
    if (entry->query == query) return *entry;
  }
  if (!strategy_exists) refuse("--strategy", strategy, strategies());
  refuse("--query", query, queries());
}

}  // namespace bvlab
