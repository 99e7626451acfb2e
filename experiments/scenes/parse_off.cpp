// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_encoding.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

/// A count; those of the header may stand on lines of their own.
std::size_t count(TextScanner& scanner, const char* what) {
  if (scanner.at_line_end()) scanner.next_line();
  const std::int64_t value = scanner.integer(what);
  if (value < 0 || value >= std::int64_t{std::numeric_limits<std::uint32_t>::max()})
    scanner.fault(std::string(what) + " cannot be " + std::to_string(value));
  return static_cast<std::size_t>(value);
}

[[noreturn]] void truncated(const std::string& name, const char* what, std::size_t held,
                            std::size_t promised) {
  throw Unusable(name, "truncated: holds " + std::to_string(held) + " of " +
                           std::to_string(promised) + " " + what + ", one a line");
}

/// Passes over the header's keyword, if there is one: [ST][C][N]OFF, to which the first count may
/// be glued.
void pass_keyword(TextScanner& scanner, const std::string& name) {
  TextScanner ahead = scanner;
  const std::string_view whole = ahead.word();
  double ignored;
  if (TextScanner::parse(whole, ignored)) return;
  std::string keyword(whole.substr(0, std::min(whole.find("OFF"), whole.find("off"))));
  const std::size_t length = keyword.size() + 3;
  if (whole.size() >= length && (keyword == "4" || keyword.ends_with('n')))
    scanner.fault(TextScanner::shown(whole) + ": only three coordinates a vertex are read");
  for (const std::string_view part : {"ST", "C", "N", "st", "c"})
    if (const auto at = keyword.find(part); at != keyword.npos) keyword.erase(at, part.size());
  const std::string_view glued = whole.substr(std::min(length, whole.size()));
  if (whole.size() < length || !keyword.empty() ||
      glued.find_first_not_of("0123456789") != glued.npos)
    scanner.fault("not an OFF file: begins with " + TextScanner::shown(whole));
  if (ahead.line().find("BINARY") != std::string_view::npos)
    scanner.fault("binary OFF is not read, only text");
  scanner.skip(length);
  if (scanner.at_line_end() && !scanner.next_line()) throw Unusable(name, "truncated: no counts");
}

/// Throws Unusable unless there are as many lines as the header promises.
void check_lines(const TextScanner& scanner, const std::string& name, std::size_t vertices,
                 std::size_t faces) {
  const std::size_t lines = scanner.lines_left();
  if (lines < vertices) truncated(name, "vertices", lines, vertices);
  if (lines < vertices + faces) truncated(name, "faces", lines - vertices, faces);
  if (lines > vertices + faces)
    throw Unusable(name, "holds " + std::to_string(lines) + " lines of vertices and faces, where " +
                             "the header promises " + std::to_string(vertices) + " and " +
                             std::to_string(faces));
}

}  // namespace

ParsedMesh parse_off(std::string_view bytes, const std::string& name) {
  std::string room;
  TextScanner scanner(as_utf8(bytes, room, name), name);
  if (!scanner.next_line()) throw Unusable(name, "holds nothing");
  pass_keyword(scanner, name);
  const std::size_t vertices = count(scanner, "the number of vertices");
  const bool one_a_line = scanner.at_line_end();
  const std::size_t faces = count(scanner, "the number of faces");
  if (one_a_line) count(scanner, "the number of edges");
  check_lines(scanner, name, vertices, faces);

  ParsedMesh parsed;
  TriangleMesh& mesh = parsed.mesh;
  mesh.vertices.reserve(vertices);
  mesh.triangles.reserve(faces);
  std::size_t values_each = 0;
  for (std::size_t i = 0; i < vertices; ++i) {
    scanner.next_line();
    const double x = scanner.coordinate(), y = scanner.coordinate(), z = scanner.coordinate();
    mesh.vertices.push_back({x, y, z});
    // A face among the vertices is told by its length.
    std::size_t values = 3;
    for (; !scanner.at_line_end(); ++values) scanner.word();
    if (i == 0) values_each = values;
    if (values != values_each)
      scanner.fault("a vertex of " + std::to_string(values) + " values, where the first has " +
                    std::to_string(values_each));
  }
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    scanner.next_line();
    const std::size_t size = count(scanner, "the number of corners");
    corners.clear();
    for (std::size_t k = 0; k < size; ++k) {
      const std::int64_t vertex = scanner.integer("the number of a vertex");
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertices)
        scanner.fault(no_vertex(vertex, vertices));
      corners.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (size < 3) parsed.note.leave_out(scanner.place());
    append_polygon(mesh, corners);
  }
  return parsed;
}

}  // namespace bvlab
