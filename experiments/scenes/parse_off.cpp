// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

/// A count of the file's header, no larger than what can be in the rest of the file.
std::size_t count(TextScanner& scanner, const char* what) {
  const std::int64_t value = scanner.integer(what);
  if (value < 0 || value >= std::int64_t{std::numeric_limits<std::uint32_t>::max()})
    scanner.fault(std::string(what) + " cannot be " + std::to_string(value));
  return static_cast<std::size_t>(value);
}

[[noreturn]] void truncated(const std::string& name, const char* what, std::size_t held,
                            std::size_t promised) {
  throw Unusable(name, "truncated: holds " + std::to_string(held) + " of " +
                           std::to_string(promised) + " " + what);
}

/// Passes over the header's keyword, if there is one: [ST][C][N]OFF.
void pass_keyword(TextScanner& scanner, const std::string& name) {
  TextScanner ahead = scanner;
  std::string_view keyword = ahead.word();
  double ignored;
  if (TextScanner::parse(keyword, ignored)) return;
  const std::string_view whole = keyword;
  for (const std::string_view part : {"ST", "C", "N"})
    if (keyword.starts_with(part)) keyword.remove_prefix(part.size());
  if (whole == "4OFF" || whole == "nOFF" || whole == "4nOFF")
    scanner.fault(TextScanner::shown(whole) + ": only three coordinates a vertex are read");
  if (keyword != "OFF") scanner.fault("not an OFF file: begins with " + TextScanner::shown(whole));
  if (ahead.line().find("BINARY") != std::string_view::npos)
    scanner.fault("binary OFF is not read, only text");
  scanner = ahead;
  if (scanner.at_line_end() && !scanner.next_line()) throw Unusable(name, "truncated: no counts");
}

}  // namespace

TriangleMesh parse_off(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name);
  if (!scanner.next_line()) throw Unusable(name, "holds nothing");
  pass_keyword(scanner, name);
  const std::size_t vertices = count(scanner, "the number of vertices");
  const std::size_t faces = count(scanner, "the number of faces");

  TriangleMesh mesh;
  // A header can promise anything; room is made for what the rest of the file can hold.
  mesh.vertices.reserve(std::min(vertices, scanner.bytes_left() / 6));
  mesh.triangles.reserve(std::min(faces, scanner.bytes_left() / 6));
  for (std::size_t i = 0; i < vertices; ++i) {
    if (!scanner.next_line()) truncated(name, "vertices", i, vertices);
    const double x = scanner.coordinate(), y = scanner.coordinate(), z = scanner.coordinate();
    mesh.vertices.push_back({x, y, z});
  }
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    if (!scanner.next_line()) truncated(name, "faces", i, faces);
    const std::size_t size = count(scanner, "the number of corners");
    corners.clear();
    for (std::size_t k = 0; k < size; ++k) {
      const std::int64_t vertex = scanner.integer("the number of a vertex");
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertices)
        scanner.fault("vertex " + std::to_string(vertex) + " does not exist: there are " +
                      std::to_string(vertices) + ", from 0");
      corners.push_back(static_cast<std::uint32_t>(vertex));
    }
    append_polygon(mesh, corners);
  }
  if (scanner.next_line())
    scanner.fault("beyond the vertices and faces that the header promises");
  return mesh;
}

}  // namespace bvlab
