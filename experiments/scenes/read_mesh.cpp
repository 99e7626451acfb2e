// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/read_mesh.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "experiments/files/unusable.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/scenes/mesh_formats.hpp"

namespace bvlab {
namespace {

std::string extension_of(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(c < 128 ? std::tolower(c) : c); });
  return extension;
}

TriangleMesh checked(TriangleMesh mesh, const std::string& name) {
  if (mesh.triangles.empty()) throw Unusable(name, "has no triangles");
  return mesh;
}

}  // namespace

TriangleMesh parse_mesh(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw Unusable(name, "is empty");
  const std::string extension = extension_of(name);
  for (const auto& format : own_formats)
    if (extension == format.extension) return checked(format.parse(bytes, name), name);
  return checked(parse_with_assimp(bytes, name, extension), name);
}

TriangleMesh read_mesh(const std::filesystem::path& path) {
  const std::string bytes = read_whole(path);
  if (bytes.empty()) throw Unusable(path.string(), "is empty");
  const std::string extension = extension_of(path.string());
  for (const auto& format : own_formats)
    if (extension == format.extension)
      return checked(format.parse(bytes, path.string()), path.string());
  return checked(read_with_assimp(path), path.string());
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
