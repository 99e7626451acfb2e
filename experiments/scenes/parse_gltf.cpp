// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/number_type.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/text_encoding.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

using Json = nlohmann::json;
using Transformation = SceneNode::Transformation;

/// A value of the JSON, and where it stands: "nodes[3].matrix".
class Value {
 public:
  Value(const Json& json, std::string place, const std::string& name)
      : json_(&json), place_(std::move(place)), name_(&name) {}

  bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
  Value operator[](const char* key) const {
    if (!has(key)) fault("has no " + std::string(key));
    return {(*json_)[key], place_.empty() ? key : place_ + "." + key, *name_};
  }
  Value operator[](std::size_t number) const {
    if (number >= size())
      fault("there is no number " + std::to_string(number) + ": it has " + std::to_string(size()));
    return {(*json_)[number], place_ + "[" + std::to_string(number) + "]", *name_};
  }
  std::size_t size() const {
    if (!json_->is_array()) fault("is not a list");
    return json_->size();
  }
  /// Calls with each entry of a list, if there is one of that name.
  template <class Visit>
  void each(const char* key, const Visit& visit) const {
    if (!has(key)) return;
    const Value list = (*this)[key];
    for (std::size_t i = 0; i < list.size(); ++i) visit(list[i]);
  }

  double number() const {
    if (!json_->is_number()) fault("is not a number");
    return json_->get<double>();
  }
  std::size_t whole() const {
    const double value = number();
    if (!(value >= 0 && value < 0x1p53) || value != std::floor(value))
      fault("is not a whole number");
    return static_cast<std::size_t>(value);
  }
  std::size_t whole(const char* key, std::size_t otherwise) const {
    return has(key) ? (*this)[key].whole() : otherwise;
  }
  template <std::size_t n>
  std::array<double, n> numbers() const {
    if (size() != n)
      fault("holds " + std::to_string(size()) + " numbers, not " + std::to_string(n));
    std::array<double, n> all;
    for (std::size_t i = 0; i < n; ++i) all[i] = (*this)[i].number();
    return all;
  }
  template <std::size_t n>
  std::array<double, n> numbers(const char* key, const std::array<double, n>& otherwise) const {
    return has(key) ? (*this)[key].numbers<n>() : otherwise;
  }
  const std::string& text() const {
    if (!json_->is_string()) fault("is not a text");
    return json_->get_ref<const std::string&>();
  }
  bool is_true(const char* key) const { return has(key) && (*json_)[key] == true; }

  [[noreturn]] void fault(const std::string& what) const {
    throw Unusable(*name_, place_.empty() ? what : place_ + ": " + what);
  }

 private:
  const Json* json_;
  std::string place_;
  const std::string* name_;
};

/// The bytes that text in base 64 stands for; nothing where it is none.
std::optional<std::string> from_base64(std::string_view text) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (int k = 0; k < 2 && text.ends_with('='); ++k) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == digits.npos) return std::nullopt;
    held = held << 6 | static_cast<std::uint32_t>(digit);
    if ((bits += 6) >= 8) bytes += static_cast<char>(held >> (bits -= 8) & 0xff);
  }
  return bytes;
}

/// A file's name as an address has it: %20 is a blank.
std::string from_percents(std::string_view text) {
  std::string name;
  for (std::size_t at = 0; at < text.size(); ++at) {
    unsigned code = 0;
    const char* const digits = text.data() + at + 1;
    const bool is_coded = text[at] == '%' && at + 2 < text.size() &&
                          std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    name += is_coded ? static_cast<char>(code) : text[at];
    if (is_coded) at += 2;
  }
  return name;
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// The text of a file, and what a GLB has beside it.
struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
  std::size_t beyond = 0;
};

Chunks chunks_of(std::string_view bytes, const std::string& name) {
  constexpr std::size_t header = 12, chunk_header = 8;
  if (!bytes.starts_with("glTF")) return {bytes, std::nullopt, 0};
  const std::size_t length = bytes.size() < header ? header : word_at(bytes, 8);
  if (length > bytes.size())
    throw Unusable(name, "truncated: holds " + std::to_string(bytes.size()) + " of " +
                             std::to_string(length) + " bytes");
  Chunks chunks{{}, std::nullopt, bytes.size() - length};
  bytes = bytes.substr(0, length);
  for (std::size_t at = header; at + chunk_header <= bytes.size();) {
    const std::size_t size = word_at(bytes, at);
    const std::uint32_t kind = word_at(bytes, at + 4);
    at += chunk_header;
    if (size > bytes.size() - at) throw Unusable(name, "truncated: ends within a chunk");
    constexpr std::uint32_t json = 0x4e4f534a, binary = 0x004e4942;
    if (kind == json && !chunks.json.data()) chunks.json = bytes.substr(at, size);
    if (kind == binary && !chunks.binary) chunks.binary = bytes.substr(at, size);
    at += size;
  }
  return chunks;
}

Json json_of(std::string_view text, const std::string& name) {
  while (!text.empty() && text.back() == '\0') text.remove_suffix(1);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const auto lines = std::count(before.begin(), before.end(), '\n');
    throw Unusable(name, TextScanner::place(static_cast<std::size_t>(lines) + 1) +
                             (before.size() >= text.size() ? ": truncated: JSON does not end"
                                                           : ": is no JSON"));
  } catch (const Json::exception&) {
    throw Unusable(name, "is JSON with a number that is not finite");
  }
}

/// glTF 2.0: what of it makes surfaces.
class Gltf {
 public:
  Gltf(const Chunks& chunks, const Json& json, const std::string& name,
       const std::filesystem::path& file)
      : chunks_(chunks), root_(json, "", name), file_(file) {}

  SceneGraph scene() {
    require_extensions();
    const Value shown = root_["scenes"][root_.whole("scene", 0)];
    shown.each("nodes", [&](const Value& root) { visit(root, Transformation::Identity(), 0); });
    if (chunks_.beyond > 0)
      note_.say(std::to_string(chunks_.beyond) + " bytes beyond the end are passed over");
    result_.note = note_.text();
    return std::move(result_);
  }

 private:
  void require_extensions() const {
    // About looks, and numbers with a type that is read.
    const auto is_read = [](const std::string& extension) {
      for (const char* part :
           {"_materials_", "_texture_", "_lights_", "_xmp", "KHR_mesh_quantization"})
        if (extension.find(part) != extension.npos) return true;
      return false;
    };
    const auto refuse = [](const Value& each) {
      each.fault("the extension " + TextScanner::shown(each.text()) + " is not read");
    };
    root_.each("extensionsRequired", [&](const Value& each) {
      if (!is_read(each.text())) refuse(each);
    });
    root_.each("extensionsUsed", [&](const Value& each) {
      if (each.text() == "EXT_mesh_gpu_instancing") refuse(each);
    });
  }

  // --- Nodes ---

  static Transformation transformation_of(const Value& node) {
    Transformation t = Transformation::Identity();
    if (node.has("matrix")) {
      const Value written = node["matrix"];
      const auto matrix = written.numbers<16>();
      if (matrix[3] != 0 || matrix[7] != 0 || matrix[11] != 0 || matrix[15] != 1)
        written.fault("its last row is not 0 0 0 1");
      return Eigen::Map<const Eigen::Matrix4d>(matrix.data()).topRows<3>();
    }
    const auto [x, y, z, w] = node.numbers<4>("rotation", {0, 0, 0, 1});
    const auto scale = node.numbers<3>("scale", {1, 1, 1}),
               translation = node.numbers<3>("translation", {0, 0, 0});
    const Eigen::Quaterniond rotation(w, x, y, z);
    if (!(std::abs(rotation.norm() - 1) <= 1e-3))
      node["rotation"].fault("is no quaternion of length 1");
    t.leftCols<3>() =
        rotation.normalized().toRotationMatrix() * Vec3<double>(scale.data()).asDiagonal();
    t.col(3) = Vec3<double>(translation.data());
    return t;
  }

  void visit(const Value& reference, const Transformation& parent, int depth) {
    const Value node = root_["nodes"][reference.whole()];
    if (depth > 1000) node.fault("nodes more than 1000 deep");
    if (!visited_.insert(reference.whole()).second) node.fault("is the child of two nodes");
    const Transformation here = product(parent, transformation_of(node));
    if (node.has("mesh")) {
      if (node.has("skin")) node["skin"].fault("skins are not applied, so not read");
      const Value mesh = root_["meshes"][node["mesh"].whole()];
      // Targets that are weighed with 0 change nothing.
      (node.has("weights") ? node : mesh).each("weights", [](const Value& weight) {
        if (weight.number() != 0) weight.fault("morph targets are not applied, so not read");
      });
      result_.nodes.push_back(
          {node.has("name") ? node["name"].text() : "", {mesh_of(node["mesh"].whole())}, here});
    }
    node.each("children", [&](const Value& child) { visit(child, here, depth + 1); });
  }

  // --- Meshes ---

  /// The number of a mesh among those of the result.
  unsigned mesh_of(std::size_t number) {
    const auto [known, is_new] =
        meshes_.try_emplace(number, static_cast<unsigned>(result_.meshes.size()));
    if (!is_new) return known->second;
    result_.meshes.emplace_back();
    std::map<std::size_t, Positions> positions;
    root_["meshes"][number].each("primitives", [&](const Value& primitive) {
      const Value attributes = primitive["attributes"];
      if (!attributes.has("POSITION")) return;
      const Value reference = attributes["POSITION"];
      const auto [from, is_new_source] = positions.try_emplace(reference.whole());
      if (is_new_source) from->second = read_positions(reference);
      append(primitive, from->second);
    });
    return known->second;
  }

  /// Where in the mesh the rows of an accessor stand.
  struct Positions {
    std::uint32_t first, count;
  };

  Positions read_positions(const Value& reference) {
    const Value accessor = root_["accessors"][reference.whole()];
    if (accessor["type"].text() != "VEC3") accessor["type"].fault("of positions is not VEC3");
    const std::vector<double> numbers = rows(accessor, 3);
    auto& vertices = result_.meshes.back().vertices;
    const std::size_t first = vertices.size(), count = numbers.size() / 3;
    if (first + count >= std::numeric_limits<std::uint32_t>::max())
      accessor.fault("more vertices than 32 bits number");
    for (std::size_t i = 0; i < count; ++i) {
      vertices.emplace_back(&numbers[3 * i]);
      if (!vertices.back().allFinite())
        accessor.fault("vertex " + std::to_string(i) + " is not finite");
    }
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
  }

  void append(const Value& primitive, const Positions& from) {
    constexpr std::size_t triangles = 4, strip = 5, fan = 6;
    const std::size_t mode = primitive.whole("mode", triangles);
    if (mode > fan) primitive["mode"].fault(std::to_string(mode) + " does not exist");
    if (mode < triangles) return;
    std::vector<std::uint32_t> corners;
    if (primitive.has("indices")) {
      const Value accessor = root_["accessors"][primitive["indices"].whole()];
      if (accessor["type"].text() != "SCALAR") accessor["type"].fault("of indices is not SCALAR");
      require_whole(accessor);
      for (const double index : rows(accessor, 1)) {
        if (!(index >= 0 && index < from.count) || index != std::floor(index))
          accessor.fault(no_vertex(static_cast<std::int64_t>(index), from.count));
        corners.push_back(from.first + static_cast<std::uint32_t>(index));
      }
    } else {
      for (std::uint32_t i = 0; i < from.count; ++i) corners.push_back(from.first + i);
    }
    TriangleMesh& mesh = result_.meshes.back();
    if (mode == strip) return append_strip(mesh, corners);
    if (mode == fan) return append_fan(mesh, corners);
    if (corners.size() % 3 != 0)
      primitive.fault("has " + std::to_string(corners.size()) + " corners, no multiple of 3");
    for (std::size_t i = 0; i < corners.size(); i += 3)
      mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }

  // --- Numbers ---

  static const NumberType& type_of(const Value& holder) {
    const Value written = holder["componentType"];
    switch (written.whole()) {
      case 5120:
        return number_type<std::int8_t>;
      case 5121:
        return number_type<std::uint8_t>;
      case 5122:
        return number_type<std::int16_t>;
      case 5123:
        return number_type<std::uint16_t>;
      case 5125:
        return number_type<std::uint32_t>;
      case 5126:
        return number_type<float>;
      default:
        written.fault("does not exist");
    }
  }

  static void require_whole(const Value& indices) {
    if (!type_of(indices).is_whole) indices["componentType"].fault("of indices is not whole");
  }

  /// The numbers of an accessor, row after row.
  std::vector<double> rows(const Value& accessor, std::size_t columns) {
    const NumberType& type = type_of(accessor);
    const std::size_t count = accessor["count"].whole();
    std::vector<double> numbers;
    if (accessor.has("bufferView")) {
      numbers = values(accessor, type, count, columns);
    } else {
      if (!accessor.has("sparse")) accessor.fault("holds no numbers");
      if (count > most_zeros) accessor.fault("is too large for rows that are not there");
      numbers.resize(count * columns);
    }
    if (accessor.has("sparse")) replace(numbers, accessor["sparse"], type, columns);
    if (accessor.is_true("normalized") && type.is_whole)
      for (double& each : numbers) each = std::max(each / type.largest, -1.0);
    return numbers;
  }

  void replace(std::vector<double>& numbers, const Value& sparse, const NumberType& type,
               std::size_t columns) {
    const std::size_t count = sparse["count"].whole();
    const Value where = sparse["indices"];
    require_whole(where);
    const auto indices = values(where, type_of(where), count, 1),
               replaced = values(sparse["values"], type, count, columns);
    for (std::size_t i = 0; i < count; ++i) {
      if (!(indices[i] >= 0 &&
            indices[i] * static_cast<double>(columns) < static_cast<double>(numbers.size())) ||
          indices[i] != std::floor(indices[i]))
        where.fault("there is no row " + std::to_string(static_cast<std::int64_t>(indices[i])));
      std::copy_n(&replaced[i * columns], columns,
                  &numbers[static_cast<std::size_t>(indices[i]) * columns]);
    }
  }

  /// What stands in a view, from an offset on.
  std::vector<double> values(const Value& holder, const NumberType& type, std::size_t count,
                             std::size_t columns) {
    const Value view = root_["bufferViews"][holder["bufferView"].whole()];
    const std::string_view bytes = bytes_of_view(view);
    const std::size_t row = type.size * columns, stride = view.whole("byteStride", row),
                      offset = holder.whole("byteOffset", 0);
    if (stride < row) view["byteStride"].fault("is less than a row");
    if (count > 0 && (offset > bytes.size() || row > bytes.size() - offset ||
                      (bytes.size() - offset - row) / stride < count - 1))
      holder.fault(std::to_string(count) + " rows of " + std::to_string(stride) + " bytes from " +
                   std::to_string(offset) + " on are not in its view of " +
                   std::to_string(bytes.size()) + " bytes");
    std::vector<double> numbers;
    numbers.reserve(count * columns);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < columns; ++k)
        numbers.push_back(type.read(bytes.data() + offset + i * stride + k * type.size));
    return numbers;
  }

  std::string_view bytes_of_view(const Value& view) {
    const std::string_view bytes = bytes_of_buffer(view["buffer"].whole());
    const std::size_t offset = view.whole("byteOffset", 0), length = view["byteLength"].whole();
    if (offset > bytes.size() || length > bytes.size() - offset)
      view.fault(std::to_string(length) + " bytes from " + std::to_string(offset) +
                 " on are not in its buffer of " + std::to_string(bytes.size()));
    return bytes.substr(offset, length);
  }

  std::string_view bytes_of_buffer(std::size_t number) {
    const auto [known, is_new] = buffers_.try_emplace(number);
    if (!is_new) return known->second;
    const Value buffer = root_["buffers"][number];
    std::string_view bytes;
    if (buffer.has("uri"))
      bytes = kept_.emplace_back(bytes_at(buffer["uri"]));
    else if (number == 0 && chunks_.binary)
      bytes = *chunks_.binary;
    else
      buffer.fault("has no uri");
    const std::size_t length = buffer["byteLength"].whole();
    if (length > bytes.size())
      buffer.fault("truncated: holds " + std::to_string(bytes.size()) + " of " +
                   std::to_string(length) + " bytes");
    return known->second = bytes.substr(0, length);
  }

  std::string bytes_at(const Value& address) const {
    const std::string& text = address.text();
    if (text.starts_with("data:")) {
      const std::string_view data = std::string_view(text).substr(text.find(',') + 1);
      auto bytes = text.find(";base64,") < text.find(',') ? from_base64(data) : std::nullopt;
      if (!bytes) address.fault("is not in base 64");
      return std::move(*bytes);
    }
    if (file_.empty())
      address.fault("refers to " + TextScanner::shown(text) + ": other files are not read here");
    try {
      return read_whole(file_.parent_path() / from_percents(text));
    } catch (const Unusable& refusal) {
      address.fault(refusal.what());
    }
  }

  static constexpr std::size_t most_zeros = 1000000;

  const Chunks& chunks_;
  Value root_;
  const std::filesystem::path& file_;
  std::map<std::size_t, std::string_view> buffers_;
  std::deque<std::string> kept_;
  std::map<std::size_t, unsigned> meshes_;
  std::set<std::size_t> visited_;
  SceneGraph result_;
  Note note_;
};

/// Of version 1, or packed by Draco: that is for assimp, which takes "2>0" for 2.0.
bool is_for_assimp(const Value& root) {
  const Value written = root["asset"]["version"];
  const std::string_view version = written.text(), major = version.substr(0, version.find('.'));
  if (major != "1" && major != "2")
    written.fault(TextScanner::shown(version) + " is not read, only 1 and 2");
  bool is_packed = false;
  root.each("extensionsUsed", [&](const Value& each) {
    is_packed = is_packed || each.text() == "KHR_draco_mesh_compression";
  });
  return is_packed || major == "1";
}

}  // namespace

std::optional<SceneGraph> parse_gltf(std::string_view bytes, const std::string& name,
                                     const std::filesystem::path& file) {
  std::string room;
  const Chunks chunks = chunks_of(as_utf8(bytes, room, name), name);
  const Json json = json_of(chunks.json, name);
  if (is_for_assimp(Value(json, "", name))) return std::nullopt;
  return Gltf(chunks, json, name, file).scene();
}

}  // namespace bvlab
