// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/arrays.hpp"

#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

std::string shape_text(const py::array& array) {
  return py::str(py::tuple(array.attr("shape"))).cast<std::string>();
}

std::string shape_text(const std::vector<Axis>& axes) {
  std::string text;
  for (const Axis& axis : axes)
    text +=
        (text.empty() ? "(" : ", ") + (axis.length < 0 ? axis.name : std::to_string(axis.length));
  return text + ")";
}

/// Calls NumPy, or what was given; whatever it does not take is unusable.
template <class Call>
auto asked(const std::string& name, const Call& call) {
  try {
    return call();
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_MemoryError) || error.matches(PyExc_KeyboardInterrupt)) throw;
    throw Unusable(name, "is not an array of numbers: " + std::string(py::str(error.value())));
  }
}

/// Whether NumPy would go through it entry by entry. Asked in the order of what is common.
bool is_sequence(const py::handle& given) {
  PyObject* object = given.ptr();
  if (PyList_CheckExact(object) || PyTuple_CheckExact(object)) return true;
  if (PyFloat_Check(object) || PyLong_Check(object) || PyUnicode_Check(object) ||
      !PySequence_Check(object) || PyObject_CheckBuffer(object))
    return false;
  for (const char* made_by : {"__array__", "__array_interface__", "__array_struct__"})
    if (py::hasattr(given, made_by)) return false;
  return true;
}

/// Sequences as lists of lists, each as long as it says, and nested as deep as there are axes:
/// NumPy goes on through one that never ends, or that holds itself again and again.
py::object as_lists(const py::handle& given, const std::string& name, const std::vector<Axis>& axes,
                    std::size_t depth = 0) {
  const auto as_it_is = py::reinterpret_borrow<py::object>(given);
  if (!is_sequence(given)) return as_it_is;
  if (depth == axes.size())
    throw Unusable(name, "nested deeper than the axes of " + shape_text(axes));
  const auto entries = asked(name, [&] { return listed(given, name); });
  if (!entries) return as_it_is;
  for (std::size_t i = 0; i < entries->size(); ++i)
    (*entries)[i] = as_lists((*entries)[i], name, axes, depth + 1);
  return *entries;
}

/// Masked entries would come in as what stands below the mask.
void refuse_masked(const py::handle& given, const std::string& name) {
  if (!py::hasattr(given, "mask") || !py::hasattr(given, "filled")) return;
  if (py::module_::import("numpy").attr("any")(given.attr("mask")).cast<bool>())
    throw Unusable(name, "has masked entries");
}

void check_kind(const py::array& array, const std::string& name, Numbers kind) {
  const char code = array.dtype().kind();
  const bool whole = code == 'i' || code == 'u';
  if (whole || (kind == Numbers::real && (code == 'f' || code == 'b'))) return;
  // An empty list is an array of float64 to NumPy.
  if (code == 'f' && array.size() == 0) return;
  throw Unusable(name, std::string(kind == Numbers::real ? "real numbers" : "integers") +
                           " are needed, not " + std::string(py::str(array.dtype())));
}

bool fits(const py::array& array, const std::vector<Axis>& axes) {
  if (array.ndim() != static_cast<py::ssize_t>(axes.size())) return false;
  for (std::size_t k = 0; k < axes.size(); ++k)
    if (axes[k].length >= 0 && array.shape(static_cast<py::ssize_t>(k)) != axes[k].length)
      return false;
  return true;
}

}  // namespace

std::optional<py::list> listed(const py::handle& given, const std::string& name) {
  if (PyList_CheckExact(given.ptr()) || PyTuple_CheckExact(given.ptr())) {
    PyObject* copy = PySequence_List(given.ptr());
    if (!copy) throw py::error_already_set();
    return py::reinterpret_steal<py::list>(copy);
  }
  const py::ssize_t length = PyObject_Size(given.ptr());
  if (length < 0) {
    if (PyErr_ExceptionMatches(PyExc_MemoryError) ||
        PyErr_ExceptionMatches(PyExc_KeyboardInterrupt))
      throw py::error_already_set();
    PyErr_Clear();
    return {};
  }
  py::list entries;
  for (const py::handle each : py::iter(given)) {
    if (static_cast<py::ssize_t>(entries.size()) == length)
      throw Unusable(name, "has more entries than its length, " + std::to_string(length));
    entries.append(each);
    // It may never come back to Python.
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return entries;
}

py::array checked_array(const py::handle& given, const std::string& name, Numbers kind,
                        const py::dtype& dtype, const std::vector<Axis>& axes) {
  // The common case: an array as it is wanted.
  if (py::isinstance<py::array>(given)) {
    const auto array = py::reinterpret_borrow<py::array>(given);
    constexpr int wanted = int{py::array::c_style} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_};
    if ((array.flags() & wanted) == wanted && fits(array, axes) &&
        Py_TYPE(given.ptr()) == py::detail::npy_api::get().PyArray_Type_ && array.dtype().is(dtype))
      return array;
  }
  refuse_masked(given, name);
  const auto numpy = py::module_::import("numpy");
  const py::object finite = as_lists(given, name, axes);
  const py::array array = asked(name, [&] { return py::array(numpy.attr("asarray")(finite)); });
  check_kind(array, name, kind);
  if (!fits(array, axes)) {
    // An empty list has no second axis.
    if (array.size() == 0 && array.ndim() == 1 && axes.size() > 1 && axes[0].length < 0) {
      std::vector<py::ssize_t> shape;
      for (std::size_t k = 0; k < axes.size(); ++k)
        shape.push_back(k == 0 ? 0 : std::max<py::ssize_t>(axes[k].length, 0));
      return asked(name, [&] { return py::array(numpy.attr("empty")(shape, dtype)); });
    }
    throw Unusable(name,
                   "shape " + shape_text(array) + ", where " + shape_text(axes) + " is needed");
  }
  return asked(name, [&] {
    // What float64 does not hold becomes infinite, which is looked for by who reads it.
    const py::object state = numpy.attr("errstate")(py::arg("all") = "ignore");
    state.attr("__enter__")();
    py::object made;
    try {
      // "A": numbers of a packed record or of bytes may begin at any address.
      made = numpy.attr("require")(array, dtype, "CA");
    } catch (...) {
      state.attr("__exit__")(py::none(), py::none(), py::none());
      throw;
    }
    state.attr("__exit__")(py::none(), py::none(), py::none());
    return py::array(made);
  });
}

}  // namespace bvlab
