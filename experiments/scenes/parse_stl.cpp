// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cstring>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

constexpr std::size_t header_bytes = 84, record_bytes = 50;

std::size_t promised_triangles(std::string_view bytes) {
  std::uint32_t count;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

TriangleMesh parse_binary(std::string_view bytes, const std::string& name) {
  const std::size_t promised = promised_triangles(bytes);
  const std::size_t held = (bytes.size() - header_bytes) / record_bytes;
  if (held < promised)
    throw Unusable(name, "truncated: holds " + std::to_string(held) + " of " +
                             std::to_string(promised) + " triangles");
  if (promised > std::numeric_limits<std::uint32_t>::max() / 3)
    throw Unusable(name, "has more vertices than 32 bits number");
  TriangleMesh mesh;
  mesh.vertices.reserve(3 * promised);
  mesh.triangles.reserve(promised);
  for (std::size_t i = 0; i < promised; ++i) {
    float numbers[9];  // after the normal, which says nothing new
    std::memcpy(numbers, bytes.data() + header_bytes + i * record_bytes + 12, sizeof numbers);
    for (int k = 0; k < 9; ++k)
      if (!std::isfinite(numbers[k]))
        throw Unusable(name, "triangle " + std::to_string(i) + ": a coordinate is not finite");
    for (int k = 0; k < 9; k += 3)
      mesh.vertices.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
    const auto first = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::string lower_case(std::string_view word) {
  std::string lower(word.substr(0, 16));
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

TriangleMesh parse_text(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name);
  TriangleMesh mesh;
  std::vector<std::uint32_t> corners;
  bool open = false, solid = false;
  while (scanner.next_line()) {
    const std::string keyword = lower_case(scanner.word());
    if (keyword == "facet") {
      open = true;
    } else if (keyword == "vertex") {
      const double x = scanner.coordinate(), y = scanner.coordinate(), z = scanner.coordinate();
      if (mesh.vertices.size() + 1 >= std::numeric_limits<std::uint32_t>::max())
        scanner.fault("more vertices than 32 bits number");
      corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back({x, y, z});
    } else if (keyword == "endloop") {
      if (corners.size() < 3) scanner.fault("a facet of fewer than three corners");
      append_polygon(mesh, corners);
      corners.clear();
    } else if (keyword == "endfacet") {
      open = false;
    } else if (keyword == "solid" || keyword == "endsolid") {
      solid = keyword == "solid";
    } else if (keyword != "outer") {
      scanner.fault("unknown word " + TextScanner::shown(keyword));
    }
  }
  if (open) throw Unusable(name, "truncated: ends within a facet");
  if (solid) throw Unusable(name, "truncated: ends without endsolid");
  return mesh;
}

}  // namespace

TriangleMesh parse_stl(std::string_view bytes, const std::string& name) {
  // Binary files may begin with "solid" too: the length tells.
  const bool has_header = bytes.size() >= header_bytes;
  if (has_header && bytes.size() == header_bytes + record_bytes * promised_triangles(bytes))
    return parse_binary(bytes, name);
  const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  if (lower_case(bytes.substr(start, 5)) == "solid") return parse_text(bytes, name);
  if (!has_header) throw Unusable(name, "not an STL file");
  return parse_binary(bytes, name);
}

}  // namespace bvlab
