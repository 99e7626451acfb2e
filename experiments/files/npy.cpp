// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/npy.hpp"

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are read as little-endian");

template <class T>
constexpr std::string_view descriptor = "";
template <>
constexpr std::string_view descriptor<float> = "<f4";
template <>
constexpr std::string_view descriptor<double> = "<f8";
template <>
constexpr std::string_view descriptor<std::uint8_t> = "|u1";
template <>
constexpr std::string_view descriptor<std::uint32_t> = "<u4";
template <>
constexpr std::string_view descriptor<std::int64_t> = "<i8";

struct Header {
  std::string type;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t data_offset = 0;
};

std::string shown(std::span<const std::size_t> shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (i) text += ", ";
    text += shape[i] == any_length ? "*" : std::to_string(shape[i]);
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

/// The header's dictionary, {'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }, as JSON:
/// other quotes and brackets, words of truth in lower case, and no comma before a bracket.
std::string as_json(std::string_view text) {
  std::string json;
  char quote = '\0';
  for (const char c : text) {
    if (quote != '\0' && c != quote) {
      json += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    } else if (c == '\'' || c == '"') {
      quote = quote == '\0' ? c : '\0';
      json += '"';
    } else if (c == '}' || c == ')') {
      const std::size_t last = json.find_last_not_of(" \t\r\n");
      const bool has_comma = last != json.npos && last > 0 && json[last] == ',';
      const auto before = has_comma ? json.find_last_not_of(" \t\r\n", last - 1) : json.npos;
      if (before != json.npos && !std::strchr(",[{", json[before])) json.erase(last);
      json += c == ')' ? ']' : '}';
      if (c == '}') break;  // what follows says nothing
    } else if (c == '[' || c == ']') {
      json += '?';
    } else {
      // What is JSON's word already is none of Python's.
      const bool begins_truth = c == 'T' || c == 'F' || c == 't' || c == 'f';
      json += c == '(' ? '[' : begins_truth ? static_cast<char>(c ^ ' ') : c;
    }
  }
  return json;
}

Header parse_dictionary(std::string_view text, const std::string& name) {
  const auto json = nlohmann::json::parse(as_json(text), nullptr, false);
  const auto has = [&](const char* key) { return json.is_object() && json.contains(key); };
  bool is_whole = json.size() == 3 && has("descr") && has("fortran_order") && has("shape") &&
                  json["descr"].is_string() && json["fortran_order"].is_boolean() &&
                  json["shape"].is_array() && json["shape"].size() <= 32;
  if (is_whole)
    for (const auto& length : json["shape"]) is_whole = is_whole && length.is_number_unsigned();
  if (!is_whole) throw Unusable(name, "malformed .npy header");
  return {json["descr"].get<std::string>(), json["fortran_order"].get<bool>(),
          json["shape"].get<std::vector<std::size_t>>(), 0};
}

Header parse_header(std::string_view bytes, const std::string& name) {
  if (bytes.size() < 10 || bytes.substr(0, 6) != "\x93NUMPY")
    throw Unusable(name, "not a .npy file");
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const int version = byte(6);
  if (version < 1 || version > 3)
    throw Unusable(name, "unknown .npy version " + std::to_string(version));
  std::size_t start = version == 1 ? 10 : 12;
  if (bytes.size() < start) throw Unusable(name, "truncated .npy header");
  std::size_t length = byte(8) | byte(9) << 8;
  if (version > 1) length |= std::size_t{byte(10)} << 16 | std::size_t{byte(11)} << 24;
  if (bytes.size() - start < length) throw Unusable(name, "truncated .npy header");
  Header header = parse_dictionary(bytes.substr(start, length), name);
  header.data_offset = start + length;
  return header;
}

/// The number of entries, once type, order, shape and length are what they have to be.
template <class T>
std::size_t checked_size(const Header& header, std::size_t bytes, const std::string& name,
                         std::span<const std::size_t> shape) {
  if (header.type != descriptor<T> && !(sizeof(T) == 1 && header.type == "u1"))
    throw Unusable(
        name, "holds '" + header.type + "' where '" + std::string(descriptor<T>) + "' is needed");
  bool fits = header.shape.size() == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i)
    fits = shape[i] == any_length || shape[i] == header.shape[i];
  if (!fits)
    throw Unusable(name,
                   "has shape " + shown(header.shape) + " where " + shown(shape) + " is needed");
  if (header.fortran_order) throw Unusable(name, "is in Fortran order; C order is needed");
  std::size_t size = 1;
  for (const std::size_t length : header.shape)
    if (length == 0)
      return bytes == header.data_offset ? 0 : throw Unusable(name, "trailing bytes");
  for (const std::size_t length : header.shape)
    if (__builtin_mul_overflow(size, length, &size))
      throw Unusable(name, "truncated: shape too large");
  const std::size_t held = (bytes - header.data_offset) / sizeof(T);
  if (held < size)
    throw Unusable(name, "truncated: holds " + std::to_string(held) + " of " +
                             std::to_string(size) + " values");
  if ((bytes - header.data_offset) != size * sizeof(T)) throw Unusable(name, "trailing bytes");
  return size;
}

}  // namespace

template <class T>
Array<T> parse_npy(std::string_view bytes, const std::string& name,
                   std::span<const std::size_t> shape) {
  const Header header = parse_header(bytes, name);
  Array<T> array{header.shape, {}};
  array.data.resize(checked_size<T>(header, bytes.size(), name, shape));
  if (!array.data.empty())
    std::memcpy(array.data.data(), bytes.data() + header.data_offset,
                array.data.size() * sizeof(T));
  return array;
}

template <class T>
Array<T> read_npy(const std::filesystem::path& path, std::span<const std::size_t> shape) {
  return parse_npy<T>(read_whole(path), path.string(), shape);
}

std::variant<Array<float>, Array<double>> read_npy_floating(const std::filesystem::path& path,
                                                            std::span<const std::size_t> shape) {
  const std::string bytes = read_whole(path);
  const std::string type = parse_header(bytes, path.string()).type;
  if (type == descriptor<float>) return parse_npy<float>(bytes, path.string(), shape);
  if (type != descriptor<double>)
    throw Unusable(path.string(), "holds '" + type + "' where '" + std::string(descriptor<float>) +
                                      "' or '" + std::string(descriptor<double>) + "' is needed");
  return parse_npy<double>(bytes, path.string(), shape);
}

Array<std::int64_t> read_npy_whole(const std::filesystem::path& path,
                                   std::span<const std::size_t> shape) {
  const std::string bytes = read_whole(path);
  const std::string type = parse_header(bytes, path.string()).type;
  if (type != descriptor<std::uint32_t>) {
    if (type != descriptor<std::int64_t>)
      throw Unusable(path.string(), "holds '" + type + "' where '<u4' or '<i8' is needed");
    return parse_npy<std::int64_t>(bytes, path.string(), shape);
  }
  const auto narrow = parse_npy<std::uint32_t>(bytes, path.string(), shape);
  return {narrow.shape, {narrow.data.begin(), narrow.data.end()}};
}

namespace {

std::string header_of(const std::string& type, std::span<const std::size_t> shape) {
  std::string dictionary =
      "{'descr': " + type + ", 'fortran_order': False, 'shape': " + shown(shape) + ", }";
  const std::size_t unpadded = 10 + dictionary.size() + 1;
  dictionary.append((64 - unpadded % 64) % 64, ' ');
  dictionary += '\n';
  std::string header = "\x93NUMPY";
  header += '\x01';
  header += '\x00';
  header += static_cast<char>(dictionary.size() & 0xff);
  header += static_cast<char>(dictionary.size() >> 8);
  return header + dictionary;
}

}  // namespace

template <class T>
std::string npy_header(std::span<const std::size_t> shape) {
  return header_of("'" + std::string(descriptor<T>) + "'", shape);
}

void write_npy_records(const std::filesystem::path& path, const std::string& fields,
                       std::span<const std::size_t> shape, std::span<const std::byte> records) {
  const std::string header = header_of(fields, shape);
  const std::string_view parts[] = {
      header, {reinterpret_cast<const char*>(records.data()), records.size()}};
  write_whole(path, parts);
}

#define BVLAB_INSTANTIATE(T)                                                                 \
  template Array<T> parse_npy<T>(std::string_view, const std::string&,                       \
                                 std::span<const std::size_t>);                              \
  template Array<T> read_npy<T>(const std::filesystem::path&, std::span<const std::size_t>); \
  template std::string npy_header<T>(std::span<const std::size_t>);
BVLAB_INSTANTIATE(float)
BVLAB_INSTANTIATE(double)
BVLAB_INSTANTIATE(std::uint8_t)
BVLAB_INSTANTIATE(std::uint32_t)
#undef BVLAB_INSTANTIATE

}  // namespace bvlab
