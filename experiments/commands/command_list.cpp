// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab list [KIND]`: one line each, the name, then what it is.
#include <cstdio>
#include <functional>
#include <map>
#include <memory>

#include "experiments/commands/commands.hpp"
#include "experiments/definitions/definition.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/peers.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/scenes.hpp"
#include "hierarchies/builds.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

void line(std::string_view name, std::string_view description) {
  std::printf("%-22.*s %.*s\n", static_cast<int>(name.size()), name.data(),
              static_cast<int>(description.size()), description.data());
}

template <class List>
void lines() {
  List::for_each([](auto type) {
    using Type = typename decltype(type)::type;
    line(Type::name, Type::description);
  });
}

template <class Range>
void lines_of(const Range& range) {
  for (const auto& each : range) line(each.name, each.description);
}

struct Kind {
  std::string_view name;
  std::function<void()> print;
};

const Kind kinds[] = {
    {"volumes",
     [] {
       lines_of(volumes());
       for (const auto& each : wide_volumes())
         line(each.name, each.description + "; --tree wide alone");
     }},
    {"trees", [] { lines_of(trees()); }},
    {"configurations", [] { lines_of(configurations()); }},
    {"strategies", [] { lines_of(strategies()); }},
    {"queries", [] { lines_of(queries()); }},
    {"methods",
     [] {
       for (const auto* method : method_entries()) line(method->name, method->description);
     }},
    {"scenes", lines<Scenes>},
    {"precisions", lines<Precisions>},
    {"builds", lines<Builds>},
    {"parameters",
     [] {
       for (const auto& each : parameters())
         line(each.name, each.what + (each.fallback.empty() ? "" : " [" + each.fallback + "]"));
     }},
    {"meshes", [] { lines_of(formula_meshes()); }},
    {"peers",
     [] {
       lines_of(peers());
       if (!absent_peer_libraries().empty())
         std::printf("left out, for these were absent when bvlab was built: %s\n",
                     std::string(absent_peer_libraries()).c_str());
     }},
};

void list(const std::string& wanted) {
  std::string names;
  for (const auto& kind : kinds) {
    if (kind.name == wanted) return kind.print();
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  if (!wanted.empty()) throw Unusable("list " + wanted + ": unknown; there are " + names);
  for (const auto& kind : kinds) {
    std::printf("%s%.*s:\n", &kind == kinds ? "" : "\n", static_cast<int>(kind.name.size()),
                kind.name.data());
    kind.print();
  }
}

}  // namespace

void add_list(CLI::App& app) {
  CLI::App* command = app.add_subcommand("list", "Lists the names of what there is");
  auto kind = std::make_shared<std::string>();
  command->add_option("kind", *kind, "one of volumes, strategies, queries, methods, scenes, ...");
  command->callback([kind] { list(*kind); });
}

}  // namespace bvlab
