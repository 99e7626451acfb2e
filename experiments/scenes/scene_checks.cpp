// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/scene_checks.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

using Json = nlohmann::json;
constexpr std::string_view blanks = " \t\r\n";

/// A COLLADA file, of which tags are found by their letters: assimp tells what is no XML.
class Collada {
 public:
  Collada(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  void require_lists() const {
    for (const std::string_view tag : {"<p>", "<h>", "<v>", "<vcount>"})
      for (std::size_t at = 0; (at = bytes_.find(tag, at)) != bytes_.npos;)
        require_indices(tag, at);
    for (std::size_t at = 0; (at = bytes_.find("<float_array", at)) != bytes_.npos;)
      require_numbers(at);
    for (std::size_t at = 0; (at = bytes_.find("<accessor", at)) != bytes_.npos; ++at)
      require_names(at);
  }

 private:
  [[noreturn]] void fault(std::size_t at, const std::string& what) const {
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
    const auto line = static_cast<std::size_t>(1 + std::count(bytes_.begin(), end, '\n'));
    throw Unusable(name_, TextScanner::place(line) + ": " + what);
  }

  void require_indices(std::string_view tag, std::size_t& at) const {
    at += tag.size();
    const std::size_t wrong = bytes_.find_first_not_of("0123456789 \t\r\n", at);
    if (wrong == bytes_.npos || bytes_[wrong] == '<') return;
    const std::size_t begin = bytes_.find_last_of("> \t\r\n", wrong) + 1;
    const std::size_t end = bytes_.find_first_of("< \t\r\n", wrong);
    fault(wrong, std::string(tag) + ": " + TextScanner::shown(bytes_.substr(begin, end - begin)) +
                     " is not an index");
  }

  void require_numbers(std::size_t& at) const {
    const std::size_t begin = at, close = std::min(bytes_.find('>', at), bytes_.size());
    const std::string_view tag = bytes_.substr(begin, close - begin);
    at = close;
    if (tag.ends_with('/')) return;
    std::size_t held = 0;
    for (at = std::min(at + 1, bytes_.size());; ++held) {
      at = std::min(bytes_.find_first_not_of(blanks, at), bytes_.size());
      if (at == bytes_.size() || bytes_[at] == '<') break;
      const std::size_t end = std::min(bytes_.find_first_of("< \t\r\n", at), bytes_.size());
      const std::string_view word = bytes_.substr(at, end - at);
      double value;
      if (!TextScanner::parse(word, value))
        fault(at, "<float_array>: " + TextScanner::shown(word) + " is not a number");
      at = end;
    }
    const std::size_t count = tag.find("count=");
    if (count == tag.npos) return;
    std::size_t promised = 0;
    const std::string_view digits = tag.substr(std::min(count + 7, tag.size()));
    std::from_chars(digits.data(), digits.data() + digits.size(), promised);
    if (promised != held)
      fault(begin, "<float_array>: holds " + std::to_string(held) +
                       " numbers, where its count is " + std::to_string(promised));
  }

  /// Values without a name are none that count.
  void require_names(std::size_t at) const {
    const std::size_t end = std::min(bytes_.find("</accessor", at), bytes_.size());
    const std::string_view accessor = bytes_.substr(at, end - at);
    std::size_t all = 0;
    for (std::size_t param = 0; (param = accessor.find("<param", param)) != accessor.npos;
         ++param) {
      const std::size_t close = std::min(accessor.find('>', param), accessor.size());
      if (accessor.substr(param, close - param).find(" name=") != accessor.npos) return;
      ++all;
    }
    if (all >= 3) fault(at, "<accessor>: none of its values has a name");
  }

  std::string_view bytes_;
  const std::string& name_;
};

/// The JSON of a glTF, of text or of a GLB's first chunk; null where there is none.
Json gltf_of(std::string_view bytes) {
  constexpr std::size_t header = 20;
  if (bytes.starts_with("glTF") && bytes.size() >= header) {
    std::uint32_t length;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    bytes = bytes.substr(header, length);
  }
  const std::size_t first = bytes.find_first_not_of(blanks);
  if (first == bytes.npos || bytes[first] != '{') return nullptr;
  Json parsed = Json::parse(bytes, nullptr, false);
  return parsed.is_object() && parsed.contains("asset") ? parsed : Json();
}

/// Whether an extension is about looks alone. (What Draco packs assimp unpacks, or refuses.)
bool is_of_looks(const std::string& extension) {
  for (const char* part : {"_materials_", "_texture_", "_lights_", "_xmp", "_draco_"})
    if (extension.find(part) != extension.npos) return true;
  return false;
}

void require_extensions(const Json& gltf, const std::string& name) {
  const auto refuse_if = [&](const char* list, const auto& is_not_read) {
    for (const Json& each : gltf.value(list, Json::array()))
      if (const auto extension = each.get<std::string>(); is_not_read(extension))
        throw Unusable(name, "needs the glTF extension " + TextScanner::shown(extension) +
                                 ", which is not read");
  };
  refuse_if("extensionsRequired", [](const std::string& each) { return !is_of_looks(each); });
  refuse_if("extensionsUsed",
            [](const std::string& each) { return each == "EXT_mesh_gpu_instancing"; });
}

void require_float_positions(const Json& gltf, const std::string& name) {
  constexpr int float32 = 5126;
  for (const Json& mesh : gltf.value("meshes", Json::array()))
    for (const Json& primitive : mesh.at("primitives")) {
      const Json& attributes = primitive.at("attributes");
      if (!attributes.contains("POSITION")) continue;
      const auto accessor = attributes.at("POSITION").get<std::size_t>();
      if (gltf.at("accessors").at(accessor).at("componentType") != float32)
        throw Unusable(
            name, "accessor " + std::to_string(accessor) + ": only positions of float32 are read");
    }
}

std::size_t triangles_of(const Json& gltf, const Json& primitive) {
  const Json& accessor = primitive.contains("indices") ? primitive.at("indices")
                                                       : primitive.at("attributes").at("POSITION");
  const auto count =
      gltf.at("accessors").at(accessor.get<std::size_t>()).at("count").get<std::size_t>();
  constexpr int triangles = 4, strip = 5, fan = 6;
  const int mode = primitive.value("mode", triangles);
  if (mode == triangles) return count / 3;
  return mode == strip || mode == fan ? std::max<std::size_t>(count, 2) - 2 : 0;
}

std::size_t triangles_below(const Json& gltf, const Json& node) {
  std::size_t sum = 0;
  if (node.contains("mesh"))
    for (const Json& each :
         gltf.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives"))
      sum += triangles_of(gltf, each);
  for (const Json& child : node.value("children", Json::array()))
    sum += triangles_below(gltf, gltf.at("nodes").at(child.get<std::size_t>()));
  return sum;
}

}  // namespace

void require_what_assimp_reads(std::string_view bytes, const std::string& name) {
  if (bytes.substr(0, 4096).find("<COLLADA") != bytes.npos)
    return Collada(bytes, name).require_lists();
  const Json gltf = gltf_of(bytes);
  if (gltf.is_null()) return;
  try {
    require_extensions(gltf, name);
    require_float_positions(gltf, name);
  } catch (const Json::exception&) {
    // Other than the format has it: assimp says what.
  }
}

std::optional<std::size_t> triangles_of_gltf(std::string_view bytes) {
  const Json gltf = gltf_of(bytes);
  if (gltf.is_null()) return std::nullopt;
  try {
    std::size_t sum = 0;
    const Json& scene = gltf.at("scenes").at(gltf.value("scene", std::size_t{0}));
    for (const Json& root : scene.at("nodes"))
      sum += triangles_below(gltf, gltf.at("nodes").at(root.get<std::size_t>()));
    return sum;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace bvlab
