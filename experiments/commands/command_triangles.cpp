// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab triangles`: does each pair of triangles in a file share a point?
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "experiments/commands/commands.hpp"
#include "experiments/files/memory.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/triangle_pairs.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

struct Arguments {
  std::string pairs, precision = std::string(Exact::name), out, json;
};

TriangleTest named_test(const std::string& name) {
  if (const TriangleTest test = triangle_test(name)) return test;
  throw Unusable("--precision", "unknown name '" + name + "'; available: " + Precisions::names());
}

void triangles(const Arguments& arguments) {
  const TriangleTest test = named_test(arguments.precision);
  const NamedFile read[] = {{"--pairs", arguments.pairs}};
  const NamedFile written[] = {place_of_totals(arguments.json), {"--out", arguments.out}};
  require_places(read, written);
  const std::vector<Triangle> corners = read_triangle_pairs(arguments.pairs);
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::uint8_t> verdicts = verdicts_on(corners, test);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (!arguments.out.empty()) {
    const std::size_t shape[] = {verdicts.size()};
    write_npy<std::uint8_t>(arguments.out, shape, verdicts);
  }
  // One frame: all pairs at once.
  Totals totals;
  totals.set("seconds", elapsed.count())
      .set("build_seconds", 0)
      .set("first_seconds", elapsed.count())
      .set("peak_bytes", peak_bytes())
      .set("frames", 1)
      .set("pairs", verdicts.size())
      .set("touching", std::count(verdicts.begin(), verdicts.end(), 1))
      .set("precision", arguments.precision);
  write_totals(totals, arguments.json);
}

}  // namespace

void add_triangles(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("triangles", "Decides whether pairs of closed triangles share a point");
  command->add_option("--pairs", arguments->pairs, "float64 .npy of shape (pairs, 18)")->required();
  command->add_option("--precision", arguments->precision, "see `bvlab list precisions`")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "uint8 .npy: 1 for each pair that shares a point");
  command->add_option("--json", arguments->json, "totals (default: standard output)");
  command->callback([arguments] { triangles(*arguments); });
}

}  // namespace bvlab
