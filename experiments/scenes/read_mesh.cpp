// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/read_mesh.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/text_encoding.hpp"

namespace bvlab {
namespace {

std::string extension_of(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(c < 128 ? std::tolower(c) : c); });
  return extension;
}

void require_scale(const ReadOptions& options) {
  if (!(options.scale > 0) || !std::isfinite(options.scale))
    throw Unusable("scale", "must be finite and above 0");
}

TriangleMesh checked(TriangleMesh mesh, const std::string& name, const ReadOptions& options) {
  if (mesh.triangles.empty()) throw Unusable(name, "has no triangles");
  return scaled_mesh(std::move(mesh), name, options);
}

}  // namespace

TriangleMesh scaled_mesh(TriangleMesh mesh, const std::string& name, const ReadOptions& options) {
  require_scale(options);
  if (options.scale == 1) return mesh;
  for (auto& vertex : mesh.vertices) {
    vertex *= options.scale;
    if (!vertex.allFinite()) throw Unusable(name, "a coordinate times the scale is not finite");
  }
  return mesh;
}

ParsedMesh parsed_mesh(std::string_view bytes, const std::string& name, const MeshFormat& format,
                       const ReadOptions& options) {
  ParsedMesh parsed = format.parse(bytes, name);
  // Of a mesh without triangles that is said alone.
  const std::string note = parsed.note.text();
  if (!note.empty() && !parsed.mesh.triangles.empty()) options.say(one_line(name + ": " + note));
  return parsed;
}

std::string bytes_of(const std::filesystem::path& path, const ReadOptions& options) {
  require_scale(options);
  std::string bytes = read_whole(path, options.on_signal);
  if (bytes.empty()) throw Unusable(path.string(), "is empty");
  return bytes;
}

void ReadOptions::say_on_standard_error(const std::string& line) {
  std::fprintf(stderr, "bvlab: %s\n", line.c_str());
}

const MeshFormat* own_format(const std::string& name) {
  const std::string extension = extension_of(name);
  for (const auto& format : own_formats)
    if (extension == format.extension) return &format;
  return nullptr;
}

SceneGraph parsed_scene(std::string_view bytes, const std::string& name, const ReadOptions& options,
                        const std::filesystem::path& file) {
  const std::string extension = extension_of(name);
  if (extension == ".zae") throw Unusable(name, "a packed DAE is not read: unpack it");
  const bool is_dae = extension == ".dae", is_3mf = extension == ".3mf";
  // A pipe is read only once; of texts with a byte-order mark assimp does not read all.
  const bool is_file = std::filesystem::is_regular_file(file) && !has_mark(bytes);
  const bool is_gltf = extension == ".gltf" || extension == ".glb";
  std::optional<SceneGraph> own;
  if (is_gltf) own = parse_gltf(bytes, name, file);
  SceneGraph scene = own       ? std::move(*own)
                     : is_dae  ? parse_dae(bytes, name)
                     : is_3mf  ? parse_3mf(bytes, name)
                     : is_file ? read_with_assimp(file, bytes)
                               : parse_with_assimp(bytes, name);
  if (!scene.note.empty()) options.say(one_line(name + ": " + scene.note));
  return scene;
}

TriangleMesh parse_mesh(std::string_view bytes, const std::string& name,
                        const ReadOptions& options) {
  if (bytes.empty()) throw Unusable(name, "is empty");
  if (const MeshFormat* format = own_format(name))
    return checked(parsed_mesh(bytes, name, *format, options).mesh, name, options);
  return checked(parsed_scene(bytes, name, options).joined(name), name, options);
}

TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string bytes = bytes_of(path, options), name = path.string();
  if (own_format(name)) return parse_mesh(bytes, name, options);
  return checked(parsed_scene(bytes, name, options, path).joined(name), name, options);
}

void say_if_nothing_is_culled(const TriangleMesh& mesh, const std::string& name) {
  double size = 0;
  for (const auto& vertex : mesh.vertices) size = std::max(size, vertex.cwiseAbs().maxCoeff());
  if (mesh.triangles.size() < 2 || size == 0 || (0x1p-50 <= size && size <= 0x1p58)) return;
  std::fprintf(stderr,
               "bvlab: %s: coordinates up to %.3g, outside of 1e-15 to 2e17: no volumes are found "
               "apart, so every pair of triangles may be tested; answers are right\n",
               one_line(name).c_str(), size);
}

void write_off(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text = "OFF\n" + std::to_string(mesh.vertices.size()) + " " +
                     std::to_string(mesh.triangles.size()) + " 0\n";
  char digits[32];
  for (const auto& vertex : mesh.vertices)
    for (int d = 0; d < 3; ++d) {
      text.append(digits, std::to_chars(digits, digits + sizeof digits, vertex[d]).ptr);
      text += d == 2 ? '\n' : ' ';
    }
  for (const auto& [i, j, k] : mesh.triangles)
    text += "3 " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(k) + "\n";
  write_whole(path, text);
}

}  // namespace bvlab
