// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <vector>

#include "experiments/files/numbers.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_encoding.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

/// A face as it was met: vertices may follow it in the file.
struct Face {
  std::size_t first, size;  // in the list of all corners
  std::size_t line;
};

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

/// Whether a line of this keyword can be passed over: it is one of the format or of a vendor, and
/// none that a vertex or a face may have been meant by.
bool says_nothing_here(std::string_view keyword) {
  if (keyword == "vt" || keyword == "vn" || keyword == "vp") return true;
  const char first = keyword[0];
  const bool is_letter = ('a' <= first && first <= 'z') || ('A' <= first && first <= 'Z');
  return is_letter && std::string_view("vVfF").find(first) == std::string_view::npos;
}

/// Whether a line of this keyword is a surface that is no polygon.
bool is_free_form(std::string_view keyword) {
  return keyword == "surf" || keyword == "bzp" || keyword == "bsp" || keyword == "cdp";
}

/// What follows a vertex's coordinates, a weight or colours, is numbers: words may be a vertex
/// whose line has lost its beginning.
void require_numbers(TextScanner& scanner) {
  while (!scanner.at_line_end()) {
    const std::string_view word = scanner.word();
    double value;
    if (!TextScanner::parse(word, value) && word.find(".#") == word.npos)
      scanner.fault(TextScanner::shown(word) + " is not a number");
  }
}

/// Whether a vertex or a face follows in the line, which a backslash at its end has joined: names
/// of folders end so.
bool hides_next_line(std::string_view line) {
  for (std::size_t at = 0; (at = line.find_first_of("\r\n", at)) != line.npos;) {
    at = std::min(line.find_first_not_of(" \t\r\n", at), line.size());
    const std::string_view next = line.substr(at, 2);
    if (next == "v " || next == "f " || next == "v\t" || next == "f\t") return true;
  }
  return false;
}

/// The numbers of vertices and of faces, which some write into the first line.
struct Counts {
  std::size_t vertices, faces;
};

std::optional<Counts> counts_of(TextScanner scanner) {
  if (!scanner.next_line()) return std::nullopt;
  const auto vertices = number_in<std::size_t>(scanner.word()),
             faces = number_in<std::size_t>(scanner.word());
  if (!vertices || !faces || !scanner.at_line_end()) return std::nullopt;
  return Counts{*vertices, *faces};
}

/// The names that faces bear, as the lines come: of an object, of a group, or of both.
class Names {
 public:
  void set_object(std::string_view name) {
    object_ = name;
    group_.clear();
  }
  void set_group(std::string_view name) { group_ = name; }
  std::string name() const {
    return object_ + (object_.empty() || group_.empty() ? "" : "/") + group_;
  }

 private:
  std::string object_, group_;
};

}  // namespace

ParsedMesh parse_obj(std::string_view bytes, const std::string& name) {
  std::string room;
  bytes = as_utf8(bytes, room, name);
  TextScanner scanner(bytes, name, {.comment = '#', .continuation = '\\'});
  ParsedMesh parsed;
  TriangleMesh& mesh = parsed.mesh;
  std::vector<Face> faces;
  std::vector<std::int64_t> corners;
  std::vector<ParsedMesh::Part> named;  // from which face on
  Names names;
  const auto counts = counts_of(scanner);
  if (counts) scanner.next_line();
  const std::size_t line_of_counts = scanner.line_number();
  while (scanner.next_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "v") {
      const double x = scanner.coordinate(), y = scanner.coordinate(), z = scanner.coordinate();
      mesh.vertices.push_back({x, y, z});
      require_numbers(scanner);
    } else if (keyword == "f" || keyword == "fo") {
      Face face{corners.size(), 0, scanner.line_number()};
      while (!scanner.at_line_end())
        corners.push_back(vertex_of(scanner, scanner.word(), mesh.vertices.size()));
      face.size = corners.size() - face.first;
      if (face.size < 3 && scanner.bytes_left() == 0 && !bytes.ends_with('\n') &&
          !bytes.ends_with('\r'))
        scanner.fault("truncated: ends within a face");
      faces.push_back(face);
    } else if (hides_next_line(scanner.line())) {
      scanner.fault("the backslash at its end makes the next line a part of it");
    } else if (keyword == "o" || keyword == "g") {
      keyword == "o" ? names.set_object(scanner.name()) : names.set_group(scanner.name());
      named.push_back({names.name(), faces.size()});
    } else if (keyword == "call") {
      scanner.fault("call: other files are not read");
    } else if (!says_nothing_here(keyword)) {
      scanner.fault("unknown word " + TextScanner::shown(keyword));
    } else if (is_free_form(keyword)) {
      parsed.note.say("surfaces of free form are left out");
    }
  }
  if (mesh.vertices.size() >= std::numeric_limits<std::uint32_t>::max())
    throw Unusable(name, "has more vertices than 32 bits number");
  if (counts && (counts->vertices != mesh.vertices.size() || counts->faces != faces.size()))
    scanner.fault("promises " + std::to_string(counts->vertices) + " vertices and " +
                      std::to_string(counts->faces) + " faces, where there are " +
                      std::to_string(mesh.vertices.size()) + " and " + std::to_string(faces.size()),
                  line_of_counts);
  std::vector<std::uint32_t> polygon;
  auto part = named.begin();
  for (const Face& face : faces) {
    const auto number = static_cast<std::size_t>(&face - faces.data());
    for (; part != named.end() && part->first <= number; ++part)
      parsed.parts.push_back({part->name, mesh.triangles.size()});
    polygon.clear();
    for (std::size_t k = 0; k < face.size; ++k) {
      const std::int64_t vertex = corners[face.first + k];
      if (static_cast<std::size_t>(vertex) >= mesh.vertices.size())
        scanner.fault("vertex " + std::to_string(vertex + 1) + " does not exist: there are " +
                          std::to_string(mesh.vertices.size()),
                      face.line);
      polygon.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (face.size < 3) parsed.note.leave_out(TextScanner::place(face.line));
    append_polygon(mesh, polygon);
  }
  return parsed;
}

}  // namespace bvlab
