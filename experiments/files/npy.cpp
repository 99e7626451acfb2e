// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/npy.hpp"

#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>

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

/// Reads the header's dictionary: {'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }
class Dictionary {
 public:
  Dictionary(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  Header parse() {
    Header header;
    bool seen[3] = {};
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr")
        header.type = quoted(), seen[0] = true;
      else if (key == "fortran_order")
        header.fortran_order = boolean(), seen[1] = true;
      else if (key == "shape")
        header.shape = tuple(), seen[2] = true;
      else
        malformed();
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (!(seen[0] && seen[1] && seen[2])) malformed();
    return header;
  }

 private:
  [[noreturn]] void malformed() const { throw Unusable(name_, "malformed .npy header"); }
  void skip() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())))
      rest_.remove_prefix(1);
  }
  bool accept(char c) {
    skip();
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!accept(c)) malformed();
  }
  std::string quoted() {
    skip();
    if (rest_.empty() || (rest_.front() != '\'' && rest_.front() != '"')) malformed();
    const std::size_t end = rest_.find(rest_.front(), 1);
    if (end == std::string_view::npos) malformed();
    std::string text(rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
    return text;
  }
  bool boolean() {
    skip();
    for (const auto& [word, value] : {std::pair("True", true), std::pair("False", false)})
      if (rest_.starts_with(word)) {
        rest_.remove_prefix(std::strlen(word));
        return value;
      }
    malformed();
  }
  std::vector<std::size_t> tuple() {
    std::vector<std::size_t> shape;
    expect('(');
    while (!accept(')')) {
      skip();
      std::size_t length = 0;
      const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), length);
      if (error != std::errc{} || shape.size() == 32) malformed();
      rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
      shape.push_back(length);
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return shape;
  }

  std::string_view rest_;
  const std::string& name_;
};

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
  Header header = Dictionary(bytes.substr(start, length), name).parse();
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
