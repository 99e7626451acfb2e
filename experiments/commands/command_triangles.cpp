// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab triangles`: does each pair of triangles in a file share a point?
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "experiments/commands/commands.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/peak_bytes.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "traversal/primitives/precisions.hpp"

namespace bvlab {
namespace {

constexpr std::size_t numbers_per_pair = 18;

struct Arguments {
  std::string pairs, precision = std::string(Exact::name), out, json;
};

/// Pairs as the intersection test takes them: triangles 2 i and 2 i + 1.
std::vector<Triangle> read_pairs(const std::string& path) {
  const std::size_t shape[] = {any_length, numbers_per_pair};
  const Array<double> array = read_npy<double>(path, shape);
  for (std::size_t i = 0; i < array.data.size(); ++i)
    if (!std::isfinite(array.data[i]))
      throw Unusable(path, "pair " + std::to_string(i / numbers_per_pair) + ", number " +
                               std::to_string(i % numbers_per_pair) + " is " +
                               (std::isnan(array.data[i]) ? "NaN" : "infinite"));
  std::vector<Triangle> triangles(array.data.size() / 9);
  for (std::size_t i = 0; i < array.data.size(); ++i)
    triangles[i / 9][i % 9 / 3][static_cast<Eigen::Index>(i % 3)] = array.data[i];
  return triangles;
}

std::vector<std::uint8_t> verdicts_on(const std::vector<Triangle>& triangles, TriangleTest test) {
  constexpr std::size_t most = 64;
  std::vector<std::uint8_t> verdicts(triangles.size() / 2);
  for (std::size_t first = 0; first < verdicts.size(); first += most) {
    const std::size_t count = std::min(most, verdicts.size() - first);
    const Triangle *a[most], *b[most];
    for (std::size_t i = 0; i < count; ++i)
      a[i] = &triangles[2 * (first + i)], b[i] = &triangles[2 * (first + i) + 1];
    const std::uint64_t hits = test(a, b, static_cast<int>(count));
    for (std::size_t i = 0; i < count; ++i) verdicts[first + i] = hits >> i & 1;
  }
  return verdicts;
}

TriangleTest named_test(const std::string& name) {
  if (const TriangleTest test = triangle_test(name)) return test;
  throw Unusable("--precision", "unknown name '" + name + "'; there are " + Precisions::names());
}

void triangles(const Arguments& arguments) {
  const TriangleTest test = named_test(arguments.precision);
  const NamedFile read[] = {{"--pairs", arguments.pairs}};
  const NamedFile written[] = {place_of_totals(arguments.json), {"--out", arguments.out}};
  require_places(read, written);
  const std::vector<Triangle> corners = read_pairs(arguments.pairs);
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
      app.add_subcommand("triangles", "Whether pairs of closed triangles share a point");
  command->add_option("--pairs", arguments->pairs, "float64 .npy of shape (pairs, 18)")->required();
  command->add_option("--precision", arguments->precision, "see `bvlab list precisions`")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "uint8 .npy: 1 where they share a point");
  command->add_option("--json", arguments->json, "totals; to standard output where not given");
  command->callback([arguments] { triangles(*arguments); });
}

}  // namespace bvlab
