// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/unzipped.hpp"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

/// Numbers of the lowest byte first, anywhere in the archive.
class Archive {
 public:
  Archive(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  [[noreturn]] void fault(const std::string& what) const { throw Unusable(name_, what); }
  std::size_t number(std::size_t at, std::size_t size) const {
    const std::string_view digits = part(at, size);
    std::size_t value = 0;
    while (size-- > 0) value = value << 8 | static_cast<unsigned char>(digits[size]);
    return value;
  }
  std::string_view part(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at)
      fault("truncated: the ZIP file ends early");
    return bytes_.substr(at, size);
  }
  std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
  const std::string& name_;
};

bool is_same(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

std::string inflated(const Archive& archive, std::string_view packed, std::size_t size) {
  // Deflate packs at most 1032 to 1.
  if (size / 1040 > packed.size())
    archive.fault("damaged: a file of impossible size in the ZIP file");
  std::string bytes(size, '\0');
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(size);
  const bool began = inflateInit2(&stream, -MAX_WBITS) == Z_OK;
  const bool is_whole =
      began && inflate(&stream, Z_FINISH) == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!is_whole) archive.fault("damaged: a file in the ZIP file cannot be unpacked");
  return bytes;
}

/// What an entry of the directory stands for.
std::string unpacked(const Archive& archive, std::size_t entry) {
  const std::size_t flags = archive.number(entry + 8, 2), method = archive.number(entry + 10, 2),
                    check = archive.number(entry + 16, 4),
                    packed_size = archive.number(entry + 20, 4),
                    size = archive.number(entry + 24, 4), at = archive.number(entry + 42, 4);
  if ((flags & 1) != 0) archive.fault("is encrypted");
  if (size == 0xffffffff || at == 0xffffffff) archive.fault("ZIP64 is not read");
  const std::size_t header = 30 + archive.number(at + 26, 2) + archive.number(at + 28, 2);
  const std::string_view packed = archive.part(at + header, packed_size);
  if (method != 0 && method != 8) archive.fault("packed by a method that is not read");
  std::string bytes = method == 8 ? inflated(archive, packed, size) : std::string(packed);
  if (bytes.size() != size || crc32(0, reinterpret_cast<const Bytef*>(bytes.data()),
                                    static_cast<uInt>(bytes.size())) != check)
    archive.fault("damaged: a file in the ZIP file is not the one that was packed");
  return bytes;
}

}  // namespace

std::optional<std::string> unzipped(std::string_view bytes, std::string_view file,
                                    const std::string& name) {
  using namespace std::string_view_literals;
  const Archive archive(bytes, name);
  constexpr std::size_t end_size = 22;
  const std::size_t end = bytes.rfind("PK\5\6"sv);
  if (end == bytes.npos || bytes.size() - end < end_size)
    archive.fault(bytes.starts_with("PK") ? "truncated: the ZIP file has no directory"
                                          : "not a ZIP file");
  std::size_t entry = archive.number(end + 16, 4);
  for (std::size_t left = archive.number(end + 10, 2); left > 0; --left) {
    if (archive.part(entry, 4) != "PK\1\2"sv) archive.fault("damaged: the ZIP file's directory");
    const std::size_t length = archive.number(entry + 28, 2);
    if (is_same(archive.part(entry + 46, length), file)) return unpacked(archive, entry);
    entry += 46 + length + archive.number(entry + 30, 2) + archive.number(entry + 32, 2);
  }
  return std::nullopt;
}

}  // namespace bvlab
