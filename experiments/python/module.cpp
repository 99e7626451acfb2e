// SPDX-License-Identifier: BSD-3-Clause
/// bvlab._bvlab: the program's functions for Python. bvlab/__init__.py is the page to start from.
#include "experiments/python/module.hpp"

#include <pybind11/stl.h>

#include <string_view>

#include "experiments/commands/kinds.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/python/arrays.hpp"

PYBIND11_MODULE(_bvlab, module) {
  namespace py = pybind11;
  using namespace bvlab;
  module.doc() = "The compiled part of bvlab; use `import bvlab`.";
  // Python's own words for what the program exits with 2 for.
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Unusable& error) {
      // A path in it may be of any bytes.
      const std::string_view text = error.what();
      const auto said = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
          text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace"));
      if (said) PyErr_SetObject(PyExc_ValueError, said.ptr());
    }
  });
  module.def(
      "names",
      [](const std::string& kind) {
        py::dict all;
        for (const auto& [name, description] : kind_of(kind).entries())
          all[py::str(name)] = description;
        return all;
      },
      py::arg("kind"), "The names of a kind and their descriptions, as `bvlab list KIND`.");
  module.def("kinds", [] {
    std::vector<std::string> all;
    for (const Kind& kind : kinds()) all.emplace_back(kind.name);
    return all;
  });
  module.def(
      "_real_array",
      [](const py::object& given, const std::string& name,
         const std::vector<std::pair<std::string, py::ssize_t>>& axes) {
        std::vector<Axis> wanted;
        for (const auto& [axis, length] : axes) wanted.push_back({axis, length});
        return array_of<double>(given, name, Numbers::real, wanted);
      },
      py::arg("given"), py::arg("name"), py::arg("axes"),
      "The array as float64 in C order; axes: names and lengths, any length where negative.");
  add_meshes(module);
  add_replaying(module);
  add_world(module);
  add_running(module);
}
