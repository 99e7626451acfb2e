// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

/// A face as it was met: vertices may follow it in the file.
struct Face {
  std::size_t first, size;  // in the list of all corners
  std::size_t line;
};

/// Line continuations are for whoever reads lines: a backslash and the end of its line are blanks.
/// (A copy is made only where there are any.)
std::string without_continuations(std::string_view bytes) {
  std::string text(bytes);
  for (std::size_t at = 0; (at = text.find('\\', at)) != std::string::npos; ++at) {
    std::size_t end = at + 1;
    while (end < text.size() && text[end] == '\r') ++end;
    if (end < text.size() && text[end] == '\n')
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(at),
                text.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
  }
  return text;
}

/// The vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn", from 0; negative ones count back from
/// the last vertex so far.
std::int64_t vertex_of(const TextScanner& scanner, std::string_view corner, std::size_t vertices) {
  const std::int64_t number =
      scanner.integer(corner.substr(0, corner.find('/')), "the number of a vertex");
  if (number == 0) scanner.fault("vertex 0 does not exist: they are numbered from 1");
  if (number > 0) return number - 1;
  if (number < -static_cast<std::int64_t>(vertices))
    scanner.fault("vertex " + std::to_string(number) + " does not exist: there are " +
                  std::to_string(vertices) + " so far");
  return static_cast<std::int64_t>(vertices) + number;
}

}  // namespace

TriangleMesh parse_obj(std::string_view bytes, const std::string& name) {
  std::string joined;
  if (bytes.find('\\') != std::string_view::npos) bytes = joined = without_continuations(bytes);
  TextScanner scanner(bytes, name);
  TriangleMesh mesh;
  std::vector<Face> faces;
  std::vector<std::int64_t> corners;
  while (scanner.next_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "v") {
      const double x = scanner.coordinate(), y = scanner.coordinate(), z = scanner.coordinate();
      mesh.vertices.push_back({x, y, z});
    } else if (keyword == "f") {
      Face face{corners.size(), 0, scanner.line_number()};
      while (!scanner.at_line_end())
        corners.push_back(vertex_of(scanner, scanner.word(), mesh.vertices.size()));
      face.size = corners.size() - face.first;
      if (face.size < 3 && scanner.bytes_left() == 0 && !bytes.ends_with('\n'))
        scanner.fault("truncated: ends within a face");
      faces.push_back(face);
    }
  }
  if (mesh.vertices.size() >= std::numeric_limits<std::uint32_t>::max())
    throw Unusable(name, "has more vertices than 32 bits number");
  std::vector<std::uint32_t> polygon;
  for (const Face& face : faces) {
    polygon.clear();
    for (std::size_t k = 0; k < face.size; ++k) {
      const std::int64_t vertex = corners[face.first + k];
      if (static_cast<std::size_t>(vertex) >= mesh.vertices.size())
        scanner.fault("vertex " + std::to_string(vertex + 1) + " does not exist: there are " +
                          std::to_string(mesh.vertices.size()),
                      face.line);
      polygon.push_back(static_cast<std::uint32_t>(vertex));
    }
    append_polygon(mesh, polygon);
  }
  return mesh;
}

}  // namespace bvlab
