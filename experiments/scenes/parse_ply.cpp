// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <vector>

#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<int>(type)];
}

std::optional<Type> type_of(std::string_view word) {
  constexpr std::pair<std::string_view, Type> names[] = {
      {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
      {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
      {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
      {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
      {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
      {"float64", Type::float64}};
  for (const auto& [name, type] : names)
    if (name == word) return type;
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  ///< of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { text, little, big };

struct Header {
  Format format = Format::text;
  std::vector<PlyElement> elements;
  std::size_t lines = 0;
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
      header.lines = scanner.line_number();
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
      Property property{{}, Type::int8, std::nullopt};
      std::string_view word = scanner.word();
      const auto type = [&](std::string_view text) {
        const auto found = type_of(text);
        if (!found) scanner.fault("unknown type " + TextScanner::shown(text));
        return *found;
      };
      if (word == "list") {
        property.count = type(scanner.word());
        word = scanner.word();
      }
      property.type = type(word);
      property.name = scanner.word();
      header.elements.back().properties.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info") {
      scanner.fault("unknown word " + TextScanner::shown(keyword));
    }
  }
  throw Unusable(name, "truncated: the header does not end");
}

/// The numbers after the header, one by one; what is read is exact in a double.
class Values {
 public:
  Values(TextScanner text, std::string_view binary, Format format)
      : text_(std::move(text)), binary_(binary), format_(format) {}

  /// Nothing at the end of the file.
  std::optional<double> next(Type type) {
    if (format_ != Format::text) return next_binary(type);
    if (text_.at_line_end() && !text_.next_line()) return std::nullopt;
    const std::string_view word = text_.word();
    double value = 0;
    if (!TextScanner::parse(word, value))
      text_.fault(TextScanner::shown(word) + " is not a number");
    // The file declares how many digits count.
    if (type == Type::float32) value = static_cast<double>(static_cast<float>(value));
    vanished_ = TextScanner::vanishes(word, value);
    return value;
  }
  /// Whether the last one was written as a number other than 0, and is 0.
  bool vanished() const { return vanished_; }
  std::size_t bytes_left() const {
    return format_ == Format::text ? text_.bytes_left() : binary_.size();
  }

 private:
  std::optional<double> next_binary(Type type) {
    const std::size_t size = size_of(type);
    if (binary_.size() < size) return std::nullopt;
    std::array<char, 8> bytes{};
    std::copy_n(binary_.begin(), size, bytes.begin());
    binary_.remove_prefix(size);
    if (format_ == Format::big)
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case Type::int8:
        return as<std::int8_t>(bytes);
      case Type::uint8:
        return as<std::uint8_t>(bytes);
      case Type::int16:
        return as<std::int16_t>(bytes);
      case Type::uint16:
        return as<std::uint16_t>(bytes);
      case Type::int32:
        return as<std::int32_t>(bytes);
      case Type::uint32:
        return as<std::uint32_t>(bytes);
      case Type::float32:
        return as<float>(bytes);
      case Type::float64:
        return as<double>(bytes);
    }
    return std::nullopt;
  }
  template <class T>
  static double as(const std::array<char, 8>& bytes) {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return static_cast<double>(value);
  }

  TextScanner text_;
  std::string_view binary_;
  Format format_;
  bool vanished_ = false;
};

class Reader {
 public:
  Reader(const Header& header, Values values, const std::string& name)
      : header_(header), values_(std::move(values)), name_(name) {
    for (const PlyElement& element : header.elements)
      if (element.name == "vertex") vertices_ = element.count;
  }

  TriangleMesh read() {
    if (vertices_ >= std::numeric_limits<std::uint32_t>::max())
      throw Unusable(name_, "has more vertices than 32 bits number");
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      for (std::uint64_t i = 0; i < element.count; ++i) read_one(element, i);
    }
    // Faces may stand before the vertices: polygons are cut when all is known.
    for (const auto& face : faces_)
      append_polygon(mesh_, std::span(corners_).subspan(face.first, face.size));
    return std::move(mesh_);
  }

 private:
  struct Face {
    std::size_t first, size;
  };

  double value(const PlyElement& element, std::uint64_t number, Type type) {
    const auto found = values_.next(type);
    if (!found)
      throw Unusable(name_, "truncated: holds " + std::to_string(number) + " of " +
                                std::to_string(element.count) + " of element " + element.name);
    return *found;
  }

  [[noreturn]] void fault(const PlyElement& element, std::uint64_t number,
                          const std::string& what) {
    throw Unusable(name_, element.name + " " + std::to_string(number) + ": " + what);
  }

  void read_one(const PlyElement& element, std::uint64_t number) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    Vec3<double> point = Vec3<double>::Zero();
    for (const Property& property : element.properties) {
      if (!property.count) {
        const double x = value(element, number, property.type);
        for (int d = 0; d < 3; ++d)
          if (property.name.size() == 1 && property.name[0] == 'x' + d) {
            if (values_.vanished())
              fault(element, number, "a coordinate is too small for its type");
            point[d] = x;
          }
        continue;
      }
      const double length = value(element, number, *property.count);
      if (!(length >= 0) || length != std::floor(length) ||
          length > static_cast<double>(values_.bytes_left()))
        fault(element, number, "a list of impossible length");
      const bool corners =
          is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
      const std::size_t first = corners_.size();
      for (auto k = static_cast<std::size_t>(length); k-- > 0;) {
        const double entry = value(element, number, property.type);
        if (!corners) continue;
        if (!(entry >= 0) || entry >= static_cast<double>(vertices_) || entry != std::floor(entry))
          fault(
              element, number,
              "a vertex that does not exist: there are " + std::to_string(vertices_) + ", from 0");
        corners_.push_back(static_cast<std::uint32_t>(entry));
      }
      if (corners) faces_.push_back({first, corners_.size() - first});
    }
    if (!is_vertex) return;
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
      fault(element, number, "a coordinate is not finite");
    mesh_.vertices.push_back(point);
  }

  const Header& header_;
  Values values_;
  const std::string& name_;
  std::uint64_t vertices_ = 0;
  TriangleMesh mesh_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> corners_;
};

/// What follows the line "end_header".
std::string_view after_lines(std::string_view bytes, std::size_t lines) {
  for (; lines > 0; --lines) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) return {};
    bytes.remove_prefix(end + 1);
  }
  return bytes;
}

}  // namespace

TriangleMesh parse_ply(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name);
  const Header header = parse_header(scanner, name);
  bool has_position[3] = {};
  std::uint64_t vertices = 0;
  for (const PlyElement& element : header.elements)
    if (element.name == "vertex") {
      if (std::exchange(vertices, element.count) != 0) throw Unusable(name, "two elements vertex");
      for (const Property& property : element.properties)
        for (int d = 0; d < 3; ++d)
          if (property.name.size() == 1 && property.name[0] == 'x' + d && !property.count)
            has_position[d] = true;
    }
  if (vertices == 0) throw Unusable(name, "has no triangles");
  if (!(has_position[0] && has_position[1] && has_position[2]))
    throw Unusable(name, "vertices without x, y, z");
  const std::string_view data = after_lines(bytes, header.lines);
  return Reader(header, Values(std::move(scanner), data, header.format), name).read();
}

}  // namespace bvlab
