// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/number_type.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_encoding.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

const NumberType* type_of(std::string_view word) {
  static constexpr std::pair<std::string_view, const NumberType*> names[] = {
      {"char", &number_type<std::int8_t>},     {"int8", &number_type<std::int8_t>},
      {"uchar", &number_type<std::uint8_t>},   {"uint8", &number_type<std::uint8_t>},
      {"short", &number_type<std::int16_t>},   {"int16", &number_type<std::int16_t>},
      {"ushort", &number_type<std::uint16_t>}, {"uint16", &number_type<std::uint16_t>},
      {"int", &number_type<std::int32_t>},     {"int32", &number_type<std::int32_t>},
      {"uint", &number_type<std::uint32_t>},   {"uint32", &number_type<std::uint32_t>},
      {"int64", &number_type<std::int64_t>},   {"uint64", &number_type<std::uint64_t>},
      {"float", &number_type<float>},          {"float32", &number_type<float>},
      {"double", &number_type<double>},        {"float64", &number_type<double>}};
  for (const auto& [name, type] : names)
    if (name == word) return type;
  return nullptr;
}

struct Property {
  std::string name;
  NumberType type;
  std::optional<NumberType> count;  ///< of a list: the type of its length

  /// In a binary file, at least; lists may be empty.
  std::size_t bytes() const { return count.value_or(type).size; }
  /// 0, 1, 2 of x, y, z; 3 of others.
  int axis() const {
    return !count && name.size() == 1 && 'x' <= name[0] && name[0] <= 'z' ? name[0] - 'x' : 3;
  }
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Property& property : properties) sum += property.bytes();
    return sum;
  }
};

/// The list that holds a face's or a strip's vertices: the one named vertex_indices or
/// vertex_index, or else the only one whose name begins as theirs.
const Property* corner_list(const PlyElement& element) {
  std::vector<const Property*> named, alike;
  for (const Property& property : element.properties) {
    if (!property.count) continue;
    if (property.name == "vertex_indices" || property.name == "vertex_index")
      named.push_back(&property);
    if (property.name.starts_with("vert") || property.name.starts_with("ind"))
      alike.push_back(&property);
  }
  if (named.empty()) named = alike;
  return named.size() == 1 ? named[0] : nullptr;
}

bool makes_surface(const PlyElement& element) {
  return element.name == "face" || element.name == "tristrips";
}

enum class Format { text, little, big };

struct Header {
  Format format = Format::text;
  std::vector<PlyElement> elements;
};

/// Reads the header's lines, and leaves the scanner at the line "end_header".
Header parse_header(TextScanner& scanner, const std::string& name) {
  if (!scanner.next_line() || scanner.word() != "ply") throw Unusable(name, "not a PLY file");
  Header header;
  bool has_format = false;
  while (scanner.next_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "end_header") {
      if (!has_format) scanner.fault("no format was given");
      return header;
    }
    if (keyword == "format") {
      const std::string_view format = scanner.word();
      has_format = true;
      if (format == "ascii")
        header.format = Format::text;
      else if (format == "binary_little_endian")
        header.format = Format::little;
      else if (format == "binary_big_endian")
        header.format = Format::big;
      else
        scanner.fault("unknown format " + TextScanner::shown(format));
    } else if (keyword == "element") {
      PlyElement element;
      element.name = scanner.word();
      const std::int64_t count = scanner.integer("the number of elements");
      if (count < 0) scanner.fault("the number of elements cannot be negative");
      element.count = static_cast<std::uint64_t>(count);
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) scanner.fault("a property of no element");
      Property property{{}, number_type<char>, std::nullopt};
      std::string_view word = scanner.word();
      const auto type = [&](std::string_view text) {
        const NumberType* found = type_of(text);
        if (!found) scanner.fault("unknown type " + TextScanner::shown(text));
        return *found;
      };
      if (word == "list") {
        property.count = type(scanner.word());
        word = scanner.word();
      }
      property.type = type(word);
      property.name = scanner.word();
      auto& others = header.elements.back().properties;
      for (const Property& other : others)
        if (other.name == property.name)
          scanner.fault("a second property " + TextScanner::shown(property.name));
      others.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info") {
      scanner.fault("unknown word " + TextScanner::shown(keyword));
    }
  }
  throw Unusable(name, "truncated: the header does not end");
}

/// The values after the header, one by one; what is read is exact in a double.
class Values {
 public:
  Values(TextScanner text, std::string_view binary, Format format)
      : text_(std::move(text)), binary_(binary), format_(format) {}

  bool is_text() const { return format_ == Format::text; }
  /// Nothing at the end of the file.
  std::optional<double> next(const NumberType& type) {
    if (!is_text()) return next_binary(type);
    if (!go_to_word()) return std::nullopt;
    const std::string_view word = text_.word();
    double value = 0;
    if (!TextScanner::parse(word, value))
      text_.fault(TextScanner::shown(word) + " is not a number");
    return value;
  }
  /// The same of a coordinate; that of a text is finite.
  std::optional<double> next_coordinate(const NumberType& type) {
    if (!is_text()) return next_binary(type);
    if (!go_to_word()) return std::nullopt;
    // The file declares how many digits count.
    return text_.coordinate(type == number_type<float> ? Digits::float32 : Digits::float64);
  }
  /// Passes over so many values, whatever they are. False at the end of the file.
  bool pass(const NumberType& type, std::uint64_t count) {
    if (!is_text()) {
      const bool is_there = count <= binary_.size() / type.size;
      if (is_there) binary_.remove_prefix(count * type.size);
      return is_there;
    }
    for (; count > 0 && go_to_word(); --count) text_.word();
    return count == 0;
  }
  std::size_t bytes_left() const { return is_text() ? text_.bytes_left() : binary_.size(); }

  TextScanner& text() { return text_; }

 private:
  /// An element may take several lines of a text.
  bool go_to_word() { return !text_.at_line_end() || text_.next_line(); }

  std::optional<double> next_binary(const NumberType& type) {
    const std::size_t size = type.size;
    if (binary_.size() < size) return std::nullopt;
    std::array<char, 8> bytes{};
    std::copy_n(binary_.begin(), size, bytes.begin());
    binary_.remove_prefix(size);
    if (format_ == Format::big)
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    return type.read(bytes.data());
  }

  TextScanner text_;
  std::string_view binary_;
  Format format_;
};

class Reader {
 public:
  Reader(const Header& header, Values values, const std::string& name)
      : header_(header), values_(std::move(values)), name_(name) {
    for (const PlyElement& element : header.elements)
      if (element.name == "vertex") vertices_ = element.count;
  }

  ParsedMesh read() {
    if (vertices_ >= std::numeric_limits<std::uint32_t>::max())
      throw Unusable(name_, "has more vertices than 32 bits number");
    check_size();
    const PlyElement* last = nullptr;
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      for (std::uint64_t i = 0; i < element.count; ++i) read_one(element, i);
      if (element.count > 0 && !makes_surface(element) && corner_list(element))
        parsed_.note.say("element " + element.name + ", which lists vertices, is passed over");
      last = &element;
    }
    if (last) check_end(*last);
    // Faces may stand before the vertices: polygons are cut when all is known.
    for (const auto& face : faces_)
      append_polygon(parsed_.mesh, std::span(corners_).subspan(face.first, face.size));
    return std::move(parsed_);
  }

 private:
  struct Face {
    std::size_t first, size;
  };

  [[noreturn]] void truncated(const PlyElement& element, std::uint64_t held) {
    throw Unusable(name_, "truncated: holds " + std::to_string(held) + " of " +
                              std::to_string(element.count) + " of element " + element.name);
  }
  [[noreturn]] void fault(const PlyElement& element, std::uint64_t number,
                          const std::string& what) {
    throw Unusable(name_, place(element, number) + ": " + what);
  }
  std::string place(const PlyElement& element, std::uint64_t number) {
    return values_.is_text() ? values_.text().place() : element.name + " " + std::to_string(number);
  }

  /// Before anything is read or room is made for it: whether the file is as long as its header
  /// needs it to be.
  void check_size() {
    std::uint64_t left = values_.is_text() ? values_.text().lines_left() : values_.bytes_left();
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      const std::uint64_t each = values_.is_text() ? 1 : element.bytes();
      if (left / each < element.count) truncated(element, left / each);
      left -= each * element.count;
    }
  }

  /// What is beyond the last element: nothing, but in a binary file less than an element is passed
  /// over.
  void check_end(const PlyElement& element) {
    std::uint64_t held = element.count;
    if (values_.is_text()) {
      if (!values_.text().at_line_end())
        values_.text().fault("more values than the header promises");
      held += values_.text().lines_left();
    } else {
      const std::size_t left = values_.bytes_left();
      while (values_.bytes_left() > 0 && pass(element)) ++held;
      if (held == element.count && left > 0)
        parsed_.note.say(std::to_string(left) + " bytes beyond the last element are passed over");
    }
    if (held > element.count)
      throw Unusable(name_, "holds " + std::to_string(held) + " of element " + element.name +
                                ", where the header promises " + std::to_string(element.count));
  }
  bool pass(const PlyElement& element) {
    for (const Property& property : element.properties) {
      const auto length = property.count ? values_.next(*property.count) : 1.0;
      if (!length || !(*length >= 0) || *length > static_cast<double>(values_.bytes_left()) ||
          !values_.pass(property.type, static_cast<std::uint64_t>(*length)))
        return false;
    }
    return true;
  }

  /// Every element of a text begins a line, so that what is missing or too much is noticed there.
  void begin(const PlyElement& element, std::uint64_t number) {
    if (!values_.is_text()) return;
    if (!values_.text().at_line_end())
      values_.text().fault("more values than the header promises for each " +
                           (number > 0 ? element.name : "element"));
    if (!values_.text().next_line()) truncated(element, number);
  }

  void read_one(const PlyElement& element, std::uint64_t number) {
    begin(element, number);
    Vec3<double> point = Vec3<double>::Zero();
    const bool is_vertex = element.name == "vertex", is_strip = element.name == "tristrips";
    const Property* corners = makes_surface(element) ? corner_list(element) : nullptr;
    for (const Property& property : element.properties) {
      const int axis = is_vertex ? property.axis() : 3;
      if (axis < 3) {
        const auto x = values_.next_coordinate(property.type);
        if (!x) truncated(element, number);
        if (!std::isfinite(*x)) fault(element, number, "a coordinate is not finite");
        point[axis] = *x;
      } else if (property.count) {
        read_list(element, number, property, &property == corners);
        if (&property != corners) continue;
        if (is_strip)
          append_strip(element, number);
        else
          append_face(element, number);
      } else if (!values_.pass(property.type, 1)) {
        truncated(element, number);
      }
    }
    if (is_vertex) parsed_.mesh.vertices.push_back(point);
  }

  /// Reads a list; its entries become `entries_` where they are corners.
  void read_list(const PlyElement& element, std::uint64_t number, const Property& property,
                 bool are_corners) {
    const auto length = values_.next(*property.count);
    if (!length) truncated(element, number);
    if (!(*length >= 0) || *length != std::floor(*length) ||
        *length > static_cast<double>(values_.bytes_left()))
      fault(element, number, "a list of impossible length");
    auto left = static_cast<std::uint64_t>(*length);
    if (!are_corners) {
      if (!values_.pass(property.type, left)) truncated(element, number);
      return;
    }
    entries_.clear();
    for (; left > 0; --left) {
      const auto entry = values_.next(property.type);
      if (!entry) truncated(element, number);
      const bool is_vertex =
          *entry >= 0 && *entry < static_cast<double>(vertices_) && *entry == std::floor(*entry);
      if (!is_vertex && !(element.name == "tristrips" && ends_strip(*entry, property.type))) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.17g", *entry);
        fault(element, number, no_vertex(digits, vertices_));
      }
      entries_.push_back(is_vertex ? static_cast<std::uint32_t>(*entry) : restart);
    }
  }

  /// -1, also where it was written as a type without sign.
  static bool ends_strip(double entry, const NumberType& type) {
    const bool has_no_sign = type.is_whole && !type.is_signed;
    return entry == -1 || (has_no_sign && entry == type.largest);
  }

  void append_face(const PlyElement& element, std::uint64_t number) {
    if (entries_.size() < 3) parsed_.note.leave_out(place(element, number));
    faces_.push_back({corners_.size(), entries_.size()});
    corners_.insert(corners_.end(), entries_.begin(), entries_.end());
  }

  /// Every vertex makes a triangle with the two before it, every other one turned about. Strips
  /// are joined by repeated vertices: what is made of those is no part of the surface.
  void append_strip(const PlyElement& element, std::uint64_t number) {
    std::size_t length = 0;
    const auto end_strip = [&] {
      if (length == 1 || length == 2) parsed_.note.leave_out(place(element, number));
      length = 0;
    };
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i] == restart) {
        end_strip();
        continue;
      }
      if (++length < 3) continue;
      std::array<std::uint32_t, 3> triangle{entries_[i - 2], entries_[i - 1], entries_[i]};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
        continue;
      if (length % 2 == 0) std::swap(triangle[0], triangle[1]);
      faces_.push_back({corners_.size(), 3});
      corners_.insert(corners_.end(), triangle.begin(), triangle.end());
    }
    end_strip();
  }

  static constexpr std::uint32_t restart = std::numeric_limits<std::uint32_t>::max();

  const Header& header_;
  Values values_;
  const std::string& name_;
  std::uint64_t vertices_ = 0;
  ParsedMesh parsed_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> corners_, entries_;
};

/// What follows the line "end_header": where lines end with CR alone, a LF after it is data.
std::string_view after_header(std::string_view bytes, const TextScanner& scanner) {
  const auto at = static_cast<std::size_t>(scanner.rest().data() - bytes.data());
  const std::size_t first_end = std::min(bytes.find_first_of("\r\n"), bytes.size());
  const bool ends_with_cr =
      bytes.substr(first_end).starts_with('\r') && !bytes.substr(first_end).starts_with("\r\n");
  return bytes.substr(ends_with_cr && at > 0 && bytes[at - 1] == '\n' ? at - 1 : at);
}

}  // namespace

ParsedMesh parse_ply(std::string_view bytes, const std::string& name) {
  std::string room;
  bytes = as_utf8(bytes, room, name);
  // What is not a number may be printed with a '#', and nothing is a comment but lines that say so.
  TextScanner scanner(bytes, name, {.comment = '\0'});
  const Header header = parse_header(scanner, name);
  bool has_position[4] = {};
  std::uint64_t vertices = 0;
  for (const PlyElement& element : header.elements) {
    if (makes_surface(element) && element.count > 0 && !corner_list(element))
      throw Unusable(
          name, "element " + element.name + " has not one list vertex_indices or vertex_index");
    if (element.name != "vertex") continue;
    if (std::exchange(vertices, element.count) != 0) throw Unusable(name, "two elements vertex");
    for (const Property& property : element.properties) has_position[property.axis()] = true;
  }
  if (vertices == 0) throw Unusable(name, "has no triangles");
  if (!(has_position[0] && has_position[1] && has_position[2]))
    throw Unusable(name, "vertices without x, y, z");
  const std::string_view data = after_header(bytes, scanner);
  return Reader(header, Values(std::move(scanner), data, header.format), name).read();
}

}  // namespace bvlab
