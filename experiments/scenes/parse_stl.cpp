// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cstring>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_encoding.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

constexpr std::size_t header_bytes = 84, record_bytes = 50;

std::size_t promised_triangles(std::string_view bytes) {
  std::uint32_t count;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

/// The bytes that follow a triangle's record, as its last two say. Many write colours there.
std::size_t announced_attributes(std::string_view bytes, std::size_t record) {
  std::uint16_t count;
  std::memcpy(&count, bytes.data() + record + record_bytes - sizeof count, sizeof count);
  return count;
}

/// Where the records begin, in a file of another size than that of `promised` of them: there may be
/// attributes between them, or a few bytes at the end.
std::vector<std::size_t> places_of_records(std::string_view bytes, std::size_t promised,
                                           ParsedMesh& parsed, const std::string& name) {
  const std::size_t held = (bytes.size() - header_bytes) / record_bytes;
  if (held < promised)
    throw Unusable(name, "truncated: holds " + std::to_string(held) + " of " +
                             std::to_string(promised) + " triangles");
  std::vector<std::size_t> plain, with_attributes;
  std::size_t at = header_bytes;
  for (std::size_t i = 0; i < promised; ++i) {
    plain.push_back(header_bytes + i * record_bytes);
    if (bytes.size() < at + record_bytes) continue;
    with_attributes.push_back(at);
    at += record_bytes + announced_attributes(bytes, at);
  }
  if (with_attributes.size() == promised && at == bytes.size()) return with_attributes;
  if (held > promised)
    throw Unusable(name, "holds " + std::to_string(held) +
                             " triangles, where the header promises " + std::to_string(promised));
  const std::size_t beyond = bytes.size() - header_bytes - promised * record_bytes;
  constexpr std::size_t end_of_line = 2;
  for (const std::size_t record : plain) {
    const std::size_t announced = announced_attributes(bytes, record);
    if (announced == 0) continue;
    // Up to here they stand where they would, so these are attributes, some of which are missing;
    // or a colour.
    if (beyond > end_of_line && announced <= bytes.size() - record - record_bytes)
      throw Unusable(name, "holds " + std::to_string(beyond) + " bytes beyond " +
                               std::to_string(promised) + " triangles, where one announces " +
                               std::to_string(announced));
    break;
  }
  parsed.note.say(std::to_string(beyond) + " bytes beyond the " + std::to_string(promised) +
                  " triangles are passed over");
  return plain;
}

ParsedMesh parse_binary(std::string_view bytes, const std::string& name) {
  ParsedMesh parsed;
  const std::size_t promised = promised_triangles(bytes);
  const bool is_plain = bytes.size() == header_bytes + record_bytes * promised;
  std::vector<std::size_t> places;
  if (!is_plain) places = places_of_records(bytes, promised, parsed, name);
  if (promised > std::numeric_limits<std::uint32_t>::max() / 3)
    throw Unusable(name, "has more vertices than 32 bits number");
  TriangleMesh& mesh = parsed.mesh;
  mesh.vertices.reserve(3 * promised);
  mesh.triangles.reserve(promised);
  for (std::size_t i = 0; i < promised; ++i) {
    float numbers[9];  // after the normal, which says nothing new
    const std::size_t place = is_plain ? header_bytes + i * record_bytes : places[i];
    std::memcpy(numbers, bytes.data() + place + 12, sizeof numbers);
    for (int k = 0; k < 9; ++k)
      if (!std::isfinite(numbers[k]))
        throw Unusable(name, "triangle " + std::to_string(i) + ": a coordinate is not finite");
    for (int k = 0; k < 9; k += 3)
      mesh.vertices.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
    const auto first = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return parsed;
}

std::string lower_case(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Text, word by word: writers differ in what they put on a line.
class TextReader {
 public:
  TextReader(std::string_view bytes, const std::string& name)
      : scanner_(bytes, name, {.comment = '\0'}), name_(name) {}

  ParsedMesh read() {
    while (scanner_.next_line()) {
      if (scanner_.line().starts_with('#')) continue;
      while (!scanner_.at_line_end()) read_word();
    }
    if (is_open_) throw Unusable(name_, "truncated: ends within a facet");
    if (is_solid_) throw Unusable(name_, "truncated: ends without endsolid");
    return std::move(parsed_);
  }

 private:
  void read_word() {
    std::string keyword = lower_case(scanner_.word());
    if (keyword == "end") keyword += lower_case(scanner_.word());
    if (keyword == "facet") {
      if (is_open_) scanner_.fault("a facet within a facet");
      is_open_ = true;
      pass_normal();
    } else if (keyword == "vertex") {
      if (!is_open_) scanner_.fault("a vertex outside of a facet");
      read_vertex();
    } else if (keyword == "endloop") {
      end_loop();
    } else if (keyword == "endfacet") {
      if (!is_open_) scanner_.fault("endfacet without a facet");
      if (!has_loop_ || !corners_.empty()) end_loop();
      is_open_ = has_loop_ = false;
    } else if (keyword == "solid" || keyword == "endsolid") {
      if (is_open_) scanner_.fault("truncated: ends within a facet");
      is_solid_ = keyword == "solid";
      const std::string name = passed_name();
      if (is_solid_) parsed_.parts.push_back({name, parsed_.mesh.triangles.size()});
    } else if (keyword.starts_with("color")) {
      for (TextScanner ahead = scanner_; is_number(ahead.word()); scanner_ = ahead) {
      }
    } else if (keyword != "outer" && keyword != "loop" && keyword != "normal") {
      scanner_.fault("unknown word " + TextScanner::shown(keyword));
    }
  }

  /// The normal says nothing new, and may be no numbers.
  void pass_normal() {
    TextScanner ahead = scanner_;
    if (lower_case(ahead.word()) != "normal") return;
    for (int k = 0; k < 3 && !is_next(ahead, "outer") && !is_next(ahead, "vertex"); ++k)
      ahead.word();
    scanner_ = ahead;
  }
  static bool is_number(std::string_view word) {
    double value;
    return TextScanner::parse(word, value);
  }
  static bool is_next(TextScanner ahead, std::string_view keyword) {
    return lower_case(ahead.word()) == keyword;
  }

  /// A name goes to the end of its line, or until a facet begins.
  std::string passed_name() {
    std::string name;
    while (!scanner_.at_line_end()) {
      TextScanner ahead = scanner_;
      const std::string_view word = ahead.word();
      if (lower_case(word) == "facet" && is_next(ahead, "normal")) break;
      name.append(name.empty() ? "" : " ").append(word);
      scanner_ = ahead;
    }
    return name;
  }

  void read_vertex() {
    const double x = scanner_.coordinate(), y = scanner_.coordinate(), z = scanner_.coordinate();
    auto& vertices = parsed_.mesh.vertices;
    if (vertices.size() + 1 >= std::numeric_limits<std::uint32_t>::max())
      scanner_.fault("more vertices than 32 bits number");
    corners_.push_back(static_cast<std::uint32_t>(vertices.size()));
    vertices.push_back({x, y, z});
  }

  void end_loop() {
    if (corners_.size() < 3) scanner_.fault("a facet of fewer than three corners");
    append_polygon(parsed_.mesh, corners_);
    corners_.clear();
    has_loop_ = true;
  }

  TextScanner scanner_;
  const std::string& name_;
  ParsedMesh parsed_;
  std::vector<std::uint32_t> corners_;
  bool is_open_ = false, has_loop_ = false, is_solid_ = false;
};

/// Binary files may begin with "solid" too, and have any words in their header; texts may begin
/// without it.
bool is_text(std::string_view bytes) {
  const std::string beginning = lower_case(bytes.substr(0, 2000));
  if (beginning.find('\0') != beginning.npos)
    return beginning.find("facet", header_bytes) != beginning.npos &&
           beginning.find("vertex", header_bytes) != beginning.npos;
  const std::size_t start = std::min(beginning.find_first_not_of(" \t\r\n"), beginning.size());
  const std::string_view first = std::string_view(beginning).substr(start);
  return first.starts_with("solid") || first.starts_with("facet") || first.starts_with("#");
}

}  // namespace

ParsedMesh parse_stl(std::string_view bytes, const std::string& name) {
  const bool has_header = bytes.size() >= header_bytes;
  if (has_header && bytes.size() == header_bytes + record_bytes * promised_triangles(bytes))
    return parse_binary(bytes, name);
  std::string room;
  // The mark of UTF-16 or none: of a binary header anything may be the beginning.
  if (const std::string_view text = as_utf8(bytes, room, name); is_text(text))
    return TextReader(text, name).read();
  if (!has_header) throw Unusable(name, "not an STL file");
  return parse_binary(bytes, name);
}

}  // namespace bvlab
