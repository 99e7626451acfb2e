// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/registry.hpp"

#include <algorithm>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

/// Those that were not named before, in order.
void add(std::vector<Named>& all, std::string_view name, std::string_view description) {
  if (!has(all, name)) all.push_back({std::string(name), std::string(description)});
}

[[noreturn]] void refuse(const char* option, std::string_view name, const std::vector<Named>& all) {
  throw Unusable(std::string(option) + " " + std::string(name) +
                 ": unknown; available: " + joined(all, &Named::name));
}

}  // namespace

bool has(const std::vector<Named>& all, std::string_view name) {
  return std::any_of(all.begin(), all.end(), [&](const Named& each) { return each.name == name; });
}

std::string name_or_first(std::string_view name, const std::vector<Named>& all) {
  return has(all, name) ? std::string(name) : all.at(0).name;
}

std::vector<Named> volumes() {
  std::vector<Named> all;
  for (const auto* entry : volume_entries()) add(all, entry->name, entry->description);
  return all;
}

std::vector<Named> wide_volumes(std::string_view kernel) {
  std::vector<Named> all;
  for (const auto* entry : wide_entries())
    if (entry->fan_out(kernel) > 0) add(all, entry->volume, entry->volume_description);
  return all;
}

std::uint32_t wide_fan_out(std::string_view volume, std::string_view kernel) {
  for (const auto* entry : wide_entries())
    if (entry->volume == volume) return entry->fan_out(kernel);
  return 0;
}

std::vector<Named> frames() {
  return {
      {std::string(name_of(Frame::world)),
       "every body is posed into the world, each volume once whenever its body has moved"},
      {std::string(name_of(Frame::body)),
       "one volume of a pair is posed into the frame of the other body, whenever it is tested"}};
}

std::vector<Named> kernels() {
  const auto fastest = [](std::string_view kernel) {
    std::uint32_t most = 0;
    for (const auto* entry : wide_entries()) most = std::max(most, entry->fan_out(kernel));
    return "; fastest with --fan-out " + std::to_string(most) + " --frame body, its defaults";
  };
  return {{"gathered", "a register holds pairs of nodes from anywhere in both trees"},
          {"siblings",
           "a register holds the children of one node, against one volume" + fastest("siblings")},
          {"mixed",
           "four children against four where nodes are alike in size, else one against sixteen "
           "grandchildren" +
               fastest("mixed")}};
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
  refuse("--volume", name, volumes());
}

void require_fit(const Variant& variant) {
  if (variant.fit != "tight") return;
  for (const auto* volume : volume_entries())
    if (volume->name == variant.volume && !volume->has_tight_fit)
      throw Unusable("--fit tight", variant.volume + " has only one fit: published");
}

const WideEntry& wide_entry(std::string_view volume, std::string_view query) {
  bool volume_exists = false;
  for (const auto* entry : wide_entries()) {
    if (entry->volume != volume) continue;
    volume_exists = true;
    if (entry->query == query) return *entry;
  }
  if (!volume_exists)
    throw Unusable("--volume " + std::string(volume) +
                   ": the kernel siblings does not take it; there is " +
                   joined(wide_volumes("siblings"), &Named::name));
  refuse("--query", query, queries());
}

const QueryEntry& query_entry(std::string_view name) {
  for (const auto* entry : query_entries())
    if (entry->query == name) return *entry;
  refuse("--query", name, queries());
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
