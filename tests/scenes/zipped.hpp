// SPDX-License-Identifier: BSD-3-Clause
/// A 3MF file around a model: a ZIP file whose files are not packed.
#pragma once

#include <zlib.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bvlab {

/// The lowest byte first.
inline std::string digits(std::size_t value, int bytes) {
  std::string text;
  for (; bytes > 0; --bytes, value >>= 8) text += static_cast<char>(value & 0xff);
  return text;
}

inline std::string zipped(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string bytes, directory;
  for (const auto& [name, file] : files) {
    const auto check =
        crc32(0, reinterpret_cast<const Bytef*>(file.data()), static_cast<uInt>(file.size()));
    // Method, time and date, check, sizes, lengths of the name and of what follows it.
    const std::string about = digits(0, 2) + digits(0, 4) + digits(check, 4) +
                              digits(file.size(), 4) + digits(file.size(), 4) +
                              digits(name.size(), 2) + digits(0, 2);
    directory += "PK\1\2" + digits(20, 2) + digits(20, 2) + digits(0, 2) + about + digits(0, 10) +
                 digits(bytes.size(), 4) + name;
    bytes += "PK\3\4" + digits(20, 2) + digits(0, 2) + about + name + file;
  }
  return bytes + directory + "PK\5\6" + digits(0, 4) + digits(files.size(), 2) +
         digits(files.size(), 2) + digits(directory.size(), 4) + digits(bytes.size(), 4) +
         digits(0, 2);
}

inline std::string as_3mf(std::string_view model) {
  const std::string relations =
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
      "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  return zipped({{"_rels/.rels", relations}, {"3D/3dmodel.model", std::string(model)}});
}

}  // namespace bvlab
