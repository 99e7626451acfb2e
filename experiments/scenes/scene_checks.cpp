// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/scene_checks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

using Json = nlohmann::json;
constexpr std::string_view blanks = " \t\r\n";

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
      const auto number = attributes.at("POSITION").get<std::size_t>();
      const Json& accessor = gltf.at("accessors").at(number);
      if (accessor.at("componentType") != float32 || accessor.at("type") != "VEC3")
        throw Unusable(name, "accessor " + std::to_string(number) +
                                 ": only positions of three float32 are read");
    }
}

/// Targets that are weighed with 0 change nothing.
bool has_weight(const Json& of) {
  for (const Json& weight : of.value("weights", Json::array()))
    if (weight != 0) return true;
  return false;
}

/// What a node does that is not applied, or that assimp applies as if it were a transformation.
void require_nodes(const Json& gltf, const std::string& name) {
  const Json nodes = gltf.value("nodes", Json::array()),
             meshes = gltf.value("meshes", Json::array());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Json& node = nodes[i];
    const auto fault = [&](const std::string& what) {
      throw Unusable(name, "node " + std::to_string(i) + ": " + what);
    };
    if (node.contains("mesh") && node.contains("skin")) fault("skins are not applied, so not read");
    if (node.contains("mesh") &&
        has_weight(node.contains("weights") ? node : meshes.at(node.at("mesh").get<std::size_t>())))
      fault("morph targets are not applied, so not read");
    if (node.contains("matrix")) {
      const auto matrix = node.at("matrix").get<std::vector<double>>();
      if (matrix.size() != 16 || matrix[3] != 0 || matrix[7] != 0 || matrix[11] != 0 ||
          matrix[15] != 1)
        fault("its matrix is no 4 by 4 whose last row is 0 0 0 1");
    }
    if (node.contains("rotation")) {
      double square = 0;
      for (const Json& each : node.at("rotation")) square += std::pow(each.get<double>(), 2);
      if (std::abs(std::sqrt(square) - 1) > 1e-3)
        fault("its rotation is no quaternion of length 1");
    }
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

using Transformation = SceneNode::Transformation;

Transformation transformation_of(const Json& node) {
  Transformation t = Transformation::Identity();
  if (node.contains("matrix")) {
    const auto matrix = node.at("matrix").get<std::array<double, 16>>();
    return Eigen::Map<const Eigen::Matrix4d>(matrix.data()).topRows<3>();
  }
  const auto three = [&](const char* name, double otherwise) {
    const auto n = node.value(name, std::array<double, 3>{otherwise, otherwise, otherwise});
    return Vec3<double>(n[0], n[1], n[2]);
  };
  const auto [x, y, z, w] = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
  t.leftCols<3>() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix() *
                    three("scale", 1).asDiagonal();
  t.col(3) = three("translation", 0);
  return t;
}

void append_transformations(std::vector<Transformation>& all, const Json& gltf, const Json& node) {
  all.push_back(transformation_of(node));
  for (const Json& child : node.value("children", Json::array()))
    append_transformations(all, gltf, gltf.at("nodes").at(child.get<std::size_t>()));
}

/// Calls with each root of the scene that is shown.
template <class Visit>
void each_root(const Json& gltf, const Visit& visit) {
  const Json& scene = gltf.at("scenes").at(gltf.value("scene", std::size_t{0}));
  for (const Json& root : scene.at("nodes")) visit(gltf.at("nodes").at(root.get<std::size_t>()));
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
  if (bytes.starts_with("glTF") && bytes.size() >= 12) {
    std::uint32_t length;
    std::memcpy(&length, bytes.data() + 8, sizeof length);
    if (length > bytes.size())
      throw Unusable(name, "truncated: holds " + std::to_string(bytes.size()) + " of " +
                               std::to_string(length) + " bytes");
  }
  const Json gltf = gltf_of(bytes);
  if (gltf.is_null()) return;
  try {
    require_extensions(gltf, name);
    require_float_positions(gltf, name);
    require_nodes(gltf, name);
  } catch (const Json::exception&) {
    // Other than the format has it: assimp says what.
  }
}

std::optional<std::size_t> triangles_of_gltf(std::string_view bytes) {
  const Json gltf = gltf_of(bytes);
  if (gltf.is_null()) return std::nullopt;
  try {
    std::size_t sum = 0;
    each_root(gltf, [&](const Json& root) { sum += triangles_below(gltf, root); });
    return sum;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::vector<Transformation> transformations_of_gltf(std::string_view bytes) {
  const Json gltf = gltf_of(bytes);
  std::vector<Transformation> all;
  if (gltf.is_null()) return all;
  try {
    each_root(gltf, [&](const Json& root) { append_transformations(all, gltf, root); });
  } catch (const Json::exception&) {
    all.clear();
  }
  return all;
}

}  // namespace bvlab
