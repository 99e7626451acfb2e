// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab list [KIND]`: one line each, the name, then what it is.
#include <cstdio>
#include <memory>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/kinds.hpp"
#include "experiments/peers/peers.hpp"

namespace bvlab {
namespace {

void print(const Kind& kind) {
  for (const auto& [name, description] : kind.entries())
    std::printf("%-22s %s\n", name.c_str(), description.c_str());
  if (kind.name == "peers" && !absent_peer_libraries().empty())
    std::printf("not available, because absent when bvlab was built: %s\n",
                std::string(absent_peer_libraries()).c_str());
}

void list(const std::string& wanted) {
  if (!wanted.empty()) return print(kind_of(wanted));
  for (const auto& kind : kinds()) {
    std::printf("%s%.*s:\n", &kind == kinds().data() ? "" : "\n",
                static_cast<int>(kind.name.size()), kind.name.data());
    print(kind);
  }
}

}  // namespace

void add_list(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "list", "Lists volumes, strategies, queries, methods, scenes, peers and more");
  auto kind = std::make_shared<std::string>();
  command->add_option("kind", *kind, "volumes, strategies, queries, ...; all kinds by default");
  command->callback([kind] { list(*kind); });
}

}  // namespace bvlab
