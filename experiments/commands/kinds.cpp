// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/kinds.hpp"

#include <string>

#include "experiments/definitions/definition.hpp"
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

template <class List>
std::vector<Named> entries() {
  std::vector<Named> all;
  List::for_each([&](auto type) {
    using Type = typename decltype(type)::type;
    all.push_back({std::string(Type::name), std::string(Type::description)});
  });
  return all;
}

template <class Range>
std::vector<Named> entries_of(const Range& range) {
  std::vector<Named> all;
  for (const auto& each : range)
    all.push_back({std::string(each.name), std::string(each.description)});
  return all;
}

std::vector<Named> methods() {
  std::vector<Named> all;
  for (const auto* method : method_entries())
    all.push_back({std::string(method->name), std::string(method->description)});
  return all;
}

std::vector<Named> all_scenes() {
  std::vector<Named> all = entries<Scenes>();
  for (auto& each : entries_of(public_scenes())) all.push_back(std::move(each));
  return all;
}

std::vector<Named> all_parameters() {
  std::vector<Named> all;
  for (const auto& each : parameters())
    all.push_back(
        {each.name, each.what + (each.fallback.empty() ? "" : " [" + each.fallback + "]")});
  return all;
}

std::vector<Named> studies() {
  std::vector<Named> all;
  for (const StudyKind* kind : study_kinds())
    all.push_back({std::string(kind->name), std::string(kind->description)});
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
    {"methods", methods},
    {"scenes", all_scenes},
    {"precisions", entries<Precisions>},
    {"builds", entries<Builds>},
    {"parameters", all_parameters},
    {"studies", studies},
    {"study-parameters", study_parameters},
    {"meshes", [] { return entries_of(formula_meshes()); }},
    {"peers", [] { return entries_of(peers()); }},
};

}  // namespace

std::span<const Kind> kinds() { return all_kinds; }

const Kind& kind_of(std::string_view name) {
  std::string names;
  for (const Kind& kind : all_kinds) {
    if (kind.name == name) return kind;
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw Unusable("list " + std::string(name) + ": unknown; available: " + names);
}

}  // namespace bvlab
