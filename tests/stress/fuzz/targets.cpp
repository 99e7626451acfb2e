// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stress/fuzz/targets.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "broadphase/box.hpp"
#include "experiments/definitions/definition.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/trace.hpp"
#include "tests/scenes/zipped.hpp"

namespace bvlab::fuzz {
namespace {

/// Not `assert`, which optimised builds leave out.
void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// Runs the reader; a refusal has to be one line that names the file.
template <class Read>
void refusing(const std::string& name, Read&& read) {
  try {
    read();
  } catch (const Unusable& refusal) {
    const std::string what = refusal.what();
    demand(what.starts_with(name + ": ") && what.size() > name.size() + 2,
           "a refusal names its file");
    demand(what.find('\n') == what.npos, "a refusal is one line");
  }
}

template <class T>
Array<T> checked(std::string_view bytes, const std::string& name,
                 std::span<const std::size_t> shape) {
  auto array = parse_npy<T>(bytes, name, shape);
  demand(array.shape.size() == shape.size(), "the shape has as many axes as were asked for");
  bool empty = false;
  for (const std::size_t length : array.shape) empty |= length == 0;
  std::size_t size = empty ? 0 : 1;
  for (const std::size_t length : array.shape)
    if (!empty) size *= length;
  demand(array.data.size() == size, "an array is as large as its shape says");
  demand(size * sizeof(T) <= bytes.size(), "no more than the file holds");
  return array;
}

template <class T>
void box_trace(std::string_view bytes) {
  const std::size_t shape[] = {any_length, any_length, 6};
  const auto array = checked<T>(bytes, "boxes.npy", shape);
  const Boxes<T> all(reinterpret_cast<const Box<T>*>(array.data.data()), array.data.size() / 6);
  const auto fault = first_fault(all);
  if (fault) demand(fault->box < all.size(), "the faulty box is one of them");
  for (std::size_t i = 0; i < (fault ? fault->box : all.size()); ++i)
    demand(overlap<Closed>(all[i], all[i]), "a box without fault overlaps itself");
}

}  // namespace

void npy(std::string_view bytes) {
  const std::size_t any[] = {any_length, any_length, any_length};
  for (std::size_t axes = 0; axes <= 3; ++axes) {
    const auto shape = std::span(any).first(axes);
    refusing("a.npy", [&] { checked<float>(bytes, "a.npy", shape); });
    refusing("a.npy", [&] { checked<double>(bytes, "a.npy", shape); });
    refusing("a.npy", [&] { checked<std::uint8_t>(bytes, "a.npy", shape); });
    refusing("a.npy", [&] { checked<std::uint32_t>(bytes, "a.npy", shape); });
  }
}

void trace(std::string_view bytes) {
  refusing("poses.npy", [&] {
    const Trace trace = parse_trace(bytes, "poses.npy");
    if (trace.objects > bytes.size()) return;
    std::vector<Pose> poses(trace.objects);
    for (std::size_t frame = 0; frame < trace.frames && trace.objects > 0; ++frame) {
      trace.poses(frame, poses);
      for (const auto& pose : poses) {
        demand(pose.translation.allFinite(), "translations are finite");
        const double off = (pose.rotation * pose.rotation.transpose() - Mat3<double>::Identity())
                               .cwiseAbs()
                               .maxCoeff();
        demand(off < 1e-14, "rotations are orthonormal up to rounding");
      }
    }
  });
}

void boxes(std::string_view bytes) {
  refusing("boxes.npy", [&] { box_trace<float>(bytes); });
  refusing("boxes.npy", [&] { box_trace<double>(bytes); });
}

void definition(std::string_view bytes) {
  refusing("experiment.toml", [&] {
    const Definition read = parse_definition(std::string(bytes), "experiment.toml");
    std::size_t product = 1;
    for (const auto& axis : read.axes) product *= axis.values.size();
    demand(product <= most_cells, "the product of the axes is bounded");
    // A full product takes its time, and another one shows nothing new.
    if (product > 1000) return;
    const auto cells = cells_of(read);
    demand(cells.size() == product, "as many cells as the axes multiply into");
    for (const auto& cell : cells)
      demand(cell.parameters.size() <= default_parameters().size(), "no parameter has two values");
  });
}

namespace {

void check(const TriangleMesh& mesh) {
  demand(!mesh.triangles.empty(), "a mesh has triangles");
  for (const auto& vertex : mesh.vertices) demand(vertex.allFinite(), "vertices are finite");
  for (const auto& triangle : mesh.triangles)
    for (const auto corner : triangle)
      demand(corner < mesh.vertices.size(), "corners are vertices");
  const Extent extent = extent_of(mesh);
  demand(extent.centre.allFinite() && extent.radius >= 0 && extent.leaf_radius >= 0,
         "the mesh has an extent");
}

/// The mesh, and its parts, which have the same triangles.
std::size_t mesh_and_parts(std::string_view bytes, const std::string& name) {
  ReadOptions quiet;
  quiet.say = [&](const std::string& line) {
    demand(line.starts_with(name + ": ") && line.find('\n') == line.npos,
           "what is said names its file, in one line");
  };
  std::size_t size = 0;
  refusing(name, [&] {
    const TriangleMesh mesh = parse_mesh(bytes, name, quiet);
    check(mesh);
    size = mesh.vertices.size() + mesh.triangles.size();
    std::size_t in_parts = 0;
    for (const MeshPart& part : parse_parts(bytes, name, quiet)) {
      check(*part.mesh);
      demand(part.pose.translation.allFinite() && part.pose.rotation.allFinite(),
             "poses are finite");
      in_parts += part.mesh->triangles.size();
    }
    demand(in_parts == mesh.triangles.size(), "parts have the triangles of the mesh");
  });
  return size;
}

}  // namespace

void mesh(std::string_view bytes) {
  if (bytes.empty()) return;
  static const std::string names[] = {"a.off", "a.obj", "a.ply", "a.stl"};
  const std::size_t size =
      mesh_and_parts(bytes.substr(1), names[static_cast<unsigned char>(bytes[0]) % 4]);
  demand(size <= 2 * bytes.size(), "no more than the file holds");
}

void scene(std::string_view bytes) {
  if (bytes.empty()) return;
  const auto kind = static_cast<unsigned char>(bytes[0]);
  bytes.remove_prefix(1);
  if (kind % 2 != 0) return void(mesh_and_parts(bytes, "a.gltf"));
  if (kind % 4 == 0) return void(mesh_and_parts(bytes, "a.dae"));
  // The model of a 3MF file, or all of that file.
  mesh_and_parts(kind % 8 == 2 ? as_3mf(bytes) : std::string(bytes), "a.3mf");
}

}  // namespace bvlab::fuzz
