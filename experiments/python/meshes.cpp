// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/meshes.hpp"

#include <pybind11/stl.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <unordered_map>

#include "experiments/files/unusable.hpp"
#include "experiments/python/signals.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {
namespace {

std::vector<Vec3<double>> vertices_from(const py::handle& given) {
  const auto array = array_of<double>(given, "vertices", Numbers::real, {{"vertices"}, {"3", 3}});
  const auto count = static_cast<std::size_t>(array.shape(0));
  const double* values = array.data();
  std::vector<Vec3<double>> vertices(count);
  for (std::size_t i = 0; i < count; ++i, values += 3) {
    vertices[i] = {values[0], values[1], values[2]};
    if (!vertices[i].allFinite())
      throw Unusable("vertices", "not a finite number in row " + std::to_string(i));
  }
  return vertices;
}

std::vector<std::array<std::uint32_t, 3>> faces_from(const py::handle& given,
                                                     std::size_t vertices) {
  // Of 64 bits and signed, so that what is negative or too large is seen as that.
  const auto array = array_of<std::int64_t>(given, "faces", Numbers::whole, {{"faces"}, {"3", 3}});
  const auto count = static_cast<std::size_t>(array.shape(0));
  if (count == 0) throw Unusable("faces", "has no triangles");
  if (std::max(count, vertices) > std::numeric_limits<std::uint32_t>::max())
    throw Unusable("faces", "more triangles or vertices than 32-bit indices can name");
  const std::int64_t* values = array.data();
  std::vector<std::array<std::uint32_t, 3>> faces(count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::uint32_t& face : faces[i]) {
      // Another thread may be writing there: what is checked is what is kept.
      const std::int64_t index = *static_cast<const volatile std::int64_t*>(values++);
      if (index < 0 || static_cast<std::uint64_t>(index) >= vertices)
        throw Unusable("faces", "index " + std::to_string(index) + " in row " + std::to_string(i) +
                                    ", where there are " + std::to_string(vertices) + " vertices");
      face = static_cast<std::uint32_t>(index);
    }
  return faces;
}

Mesh mesh_from(const py::handle& vertices, const py::handle& faces) {
  TriangleMesh mesh;
  mesh.vertices = vertices_from(vertices);
  mesh.triangles = faces_from(faces, mesh.vertices.size());
  return Mesh(std::make_shared<const TriangleMesh>(std::move(mesh)));
}

std::shared_ptr<Mesh> made(const py::object& vertices, const py::object& faces) {
  return std::make_shared<Mesh>(faces.is_none() ? mesh_of(vertices) : mesh_from(vertices, faces));
}

std::shared_ptr<Mesh> shared(TriangleMesh&& mesh) {
  return std::make_shared<Mesh>(std::make_shared<const TriangleMesh>(std::move(mesh)));
}

/// Reads by `read_file` without the lock of the interpreter: Ctrl-C ends waiting for a pipe, and
/// what is to be said of a file is a warning.
template <class Read>
auto reading(double scale, const Read& read_file) {
  std::vector<std::string> said;
  auto result = released([&] {
    ReadOptions options;
    options.scale = scale;
    options.say = [&](const std::string& line) { said.push_back(line); };
    options.on_signal = [] {
      const py::gil_scoped_acquire held;
      if (PyErr_CheckSignals() != 0) throw Interrupted();
    };
    return read_file(options);
  });
  for (const auto& line : said)
    if (PyErr_WarnEx(PyExc_UserWarning, line.c_str(), 1) != 0) throw py::error_already_set();
  return result;
}

/// pybind11's own way takes names with a zero byte for another type.
std::filesystem::path path_from(const py::object& given) {
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(given.ptr(), &bytes) == 0) {
    if (!PyErr_ExceptionMatches(PyExc_ValueError)) throw py::error_already_set();
    PyErr_Clear();
    throw Unusable(py::repr(given), "is no name of a file");
  }
  return std::string(py::reinterpret_steal<py::bytes>(bytes));
}

std::shared_ptr<Mesh> read(const py::object& given, double scale) {
  const auto path = path_from(given);
  return shared(
      reading(scale, [&](const ReadOptions& options) { return read_mesh(path, options); }));
}

/// Name, mesh, and pose as a row of a trace; nodes alike share one mesh.
py::list read_all_parts(const py::object& given, double scale) {
  const auto path = path_from(given);
  const auto parts =
      reading(scale, [&](const ReadOptions& options) { return read_parts(path, options); });
  std::unordered_map<const TriangleMesh*, std::shared_ptr<Mesh>> known;
  py::list all;
  for (const MeshPart& part : parts) {
    auto& mesh = known[part.mesh.get()];
    if (!mesh) mesh = std::make_shared<Mesh>(part.mesh);
    const Vec3<double>& t = part.pose.translation;
    const Eigen::Quaterniond q(part.pose.rotation);
    py::array_t<double> pose(7);
    std::copy_n(std::array{t[0], t[1], t[2], q.w(), q.x(), q.y(), q.z()}.begin(), 7,
                pose.mutable_data());
    // Names in files may be in any encoding.
    const py::object name = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
        part.name.data(), static_cast<py::ssize_t>(part.name.size()), "replace"));
    all.append(py::make_tuple(mesh, name, pose));
  }
  return all;
}

std::shared_ptr<Mesh> named(const std::string& name, std::size_t polygons) {
  const py::gil_scoped_release released;
  return shared(named_mesh(name, polygons).mesh);
}

/// Copies of them, one behind the other: those that were made last time if they are of the same.
std::shared_ptr<const std::vector<TriangleMesh>> side_by_side(const std::vector<Mesh>& meshes) {
  SideBySide& last = *meshes.front().last;
  const auto is_of = [](const std::weak_ptr<const TriangleMesh>& held, const Mesh& mesh) {
    return held.lock() == mesh.triangles;
  };
  if (!std::equal(last.of.begin(), last.of.end(), meshes.begin(), meshes.end(), is_of)) {
    auto copies = std::make_shared<std::vector<TriangleMesh>>();
    copies->reserve(meshes.size());
    for (const Mesh& mesh : meshes) copies->push_back(*mesh.triangles);
    last = {{}, std::move(copies)};
    for (const Mesh& mesh : meshes) last.of.push_back(mesh.triangles);
  }
  return last.copies;
}

/// For tests: where the engine reads the vertices of each.
std::vector<std::uintptr_t> places_of(const py::object& meshes) {
  const Meshes given(meshes);
  std::vector<std::uintptr_t> places;
  for (const TriangleMesh& mesh : given.span())
    places.push_back(reinterpret_cast<std::uintptr_t>(mesh.vertices.data()));
  return places;
}

/// What the mesh holds, seen as an array that keeps it alive.
template <class T, class Row>
py::array_t<T> view(const std::vector<Row>& rows, const py::object& owner) {
  static_assert(sizeof(Row) == 3 * sizeof(T));
  py::array_t<T> array({static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}},
                       reinterpret_cast<const T*>(rows.data()), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

}  // namespace

Mesh mesh_of(const py::handle& given) {
  if (py::isinstance<Mesh>(given)) return given.cast<Mesh>();
  if (py::hasattr(given, "vertices") && py::hasattr(given, "faces"))
    return mesh_from(given.attr("vertices"), given.attr("faces"));
  throw Unusable("mesh", "a bvlab.Mesh, or something with .vertices and .faces, is needed, not " +
                             std::string(py::str(py::type::of(given).attr("__name__"))));
}

Meshes::Meshes(const py::handle& given, std::size_t at_least) {
  std::vector<Mesh> all;
  const bool one = py::isinstance<Mesh>(given) || py::hasattr(given, "vertices");
  if (one) {
    all.push_back(mesh_of(given));
  } else {
    const auto entries = listed(given, "meshes");
    if (!entries)
      throw Unusable("meshes", "a list of meshes is needed, not " +
                                   std::string(py::str(py::type::of(given).attr("__name__"))));
    // The same object twice is one mesh, also where it is not ours; `entries` keeps its address.
    std::unordered_map<PyObject*, std::size_t> known;
    for (const auto& each : *entries) {
      const auto [at, fresh] = known.try_emplace(each.ptr(), all.size());
      all.push_back(fresh ? mesh_of(each) : all[at->second]);
    }
  }
  if (all.size() < at_least) throw Unusable("meshes", "at least one is needed");
  given_ = all.size();
  if (all.empty()) return;
  const auto repeats = [&](std::size_t period) {
    for (std::size_t i = period; i < all.size(); ++i)
      if (all[i].triangles != all[i - period].triangles) return false;
    return true;
  };
  std::size_t period = 1;
  while (all.size() % period != 0 || !repeats(period)) ++period;
  if (period == 1) {
    one_ = all[0].triangles;
    span_ = {one_.get(), 1};
    return;
  }
  several_ = side_by_side({all.begin(), all.begin() + static_cast<std::ptrdiff_t>(period)});
  of_several_ = all[0].last->of;
  span_ = *several_;
}

const TriangleMesh& Meshes::place_of(const Mesh& mesh) const {
  for (std::size_t i = 0; i < of_several_.size(); ++i)
    if (of_several_[i].lock() == mesh.triangles) return span_[i];
  return *mesh.triangles;
}

void add_meshes(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>>(module, "Mesh", py::module_local(),
                                          R"(Triangles over shared vertices; read-only.

Mesh(vertices, faces)    (n, 3) real, in any unit, and (m, 3) integer: indices of vertices
Mesh(other)              anything with .vertices and .faces, as trimesh's meshes have

Any real dtype, C or Fortran order; kept as float64. Open, self-intersecting and degenerate meshes
are legal. ValueError: another shape or type, NaN, infinity, an index out of range, no triangle.)")
      .def(py::init(&made), py::arg("vertices"), py::arg("faces") = py::none())
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view<double>(self.cast<const Mesh&>().triangles->vertices, self);
          },
          "(n, 3) float64, read-only: no copy.")
      .def_property_readonly(
          "faces",
          [](const py::object& self) {
            return view<std::uint32_t>(self.cast<const Mesh&>().triangles->triangles, self);
          },
          "(m, 3) uint32, read-only: indices of vertices; no copy.")
      .def("__len__", [](const Mesh& mesh) { return mesh.triangles->triangles.size(); })
      // For pickle and copy; a class of one's own made of this may have more.
      .def("__reduce__",
           [](const py::object& self) {
             return py::make_tuple(py::type::of(self),
                                   py::make_tuple(self.attr("vertices"), self.attr("faces")),
                                   py::getattr(self, "__dict__", py::none()));
           })
      .def("__repr__", [](const Mesh& mesh) {
        return "<bvlab.Mesh: " + std::to_string(mesh.triangles->vertices.size()) + " vertices, " +
               std::to_string(mesh.triangles->triangles.size()) + " triangles>";
      });
  module.def("_places_of", &places_of, py::arg("meshes"),
             "The address from which each mesh's vertices are read, for tests.");
  module.def(
      "read", &read, py::arg("path"), py::kw_only(), py::arg("scale") = 1.0,
      R"(The mesh in a file: OFF, OBJ, PLY, STL, DAE, 3MF and glTF to the last digit, others as assimp reads
them (coordinates in float32).

The transformations of a scene's nodes are applied. Coordinates are used as they stand, whatever
unit and axes the file names, and multiplied by `scale`. Skins and morph targets are refused.
ValueError: missing, truncated, or no mesh; names the file, what is wrong, and where. UserWarning:
what was passed over.)");
  module.def("_read_parts", &read_all_parts, py::arg("path"), py::arg("scale"));
  module.def("named_mesh", &named, py::arg("name"), py::arg("polygons") = 500,
             R"(A mesh by name, as definitions name them: "bunny", "torus", "bunny-hull".

See bvlab.formula_meshes() for those made by formula. It has about `polygons` triangles.)");
}

}  // namespace bvlab
