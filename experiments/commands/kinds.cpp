// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/kinds.hpp"

#include <string>

#include "experiments/definitions/definition.hpp"
#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/public/public_scenes.hpp"
#include "experiments/scenes/scenes.hpp"
#include "experiments/studies/study.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

template <class Entry>
Named named(const Entry& entry) {
  return {std::string(entry.name), std::string(entry.description)};
}
template <class Entry>
Named named(const Entry* entry) {
  return named(*entry);
}

template <class List>
std::vector<Named> entries() {
  std::vector<Named> all;
  List::for_each([&]<class Type>(std::type_identity<Type>) {
    all.push_back({std::string(Type::name), std::string(Type::description)});
  });
  return all;
}

/// Of a function that returns a range.
template <auto range>
std::vector<Named> entries_of() {
  std::vector<Named> all;
  for (const auto& each : range()) all.push_back(named(each));
  return all;
}

std::vector<Named> all_scenes() {
  std::vector<Named> all = entries<Scenes>();
  for (const auto& each : public_scenes()) all.push_back(named(each));
  return all;
}

std::vector<Named> all_parameters() {
  std::vector<Named> all;
  for (const auto& each : parameters())
    all.push_back(
        {each.name, each.what + (each.fallback.empty() ? "" : " [" + each.fallback + "]")});
  return all;
}

std::vector<Named> study_parameters() {
  std::vector<Named> all;
  for (const StudyKind* kind : study_kinds())
    for (const auto& each : kind->parameters())
      all.push_back({std::string(kind->name) + "." + each.name, each.description()});
  return all;
}

constexpr Kind all_kinds[] = {
    {"volumes", volumes},
    {"frames", frames},
    {"kernels", kernels},
    {"configurations", configurations},
    {"strategies", strategies},
    {"queries", queries},
    {"methods", entries_of<method_entries>},
    {"scenes", all_scenes},
    {"precisions", entries<Precisions>},
    {"builds", entries<Builds>},
    {"parameters", all_parameters},
    {"studies", entries_of<study_kinds>},
    {"study-parameters", study_parameters},
    {"meshes", entries_of<formula_meshes>},
    {"peers", entries_of<peers>},
};

}  // namespace

std::span<const Kind> kinds() { return all_kinds; }

const Kind& kind_of(std::string_view name) {
  for (const Kind& kind : all_kinds)
    if (kind.name == name) return kind;
  throw Unusable("list " + std::string(name) +
                 ": unknown; available: " + joined(all_kinds, &Kind::name));
}

}  // namespace bvlab
