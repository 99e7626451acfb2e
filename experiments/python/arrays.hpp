// SPDX-License-Identifier: BSD-3-Clause
/// NumPy's arrays as they come in and go out. What comes in is checked before anything is made of
/// it; what goes out is not copied.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/files/unusable.hpp"

namespace bvlab {

namespace py = pybind11;

/// Base of what Python sees. `T.__new__(T)` makes an object without a T, and where that is used
/// pybind11 asks T for fresh memory: there is none to be had. A T is made by std::make_shared.
struct MadeByCalls {
  static void* operator new(std::size_t) {
    throw py::type_error("was made by __new__ alone, and holds nothing: call its class");
  }
};

enum class Numbers { real, whole };

/// A length that an axis may have, whatever it is; its name stands in messages.
struct Axis {
  std::string name;
  py::ssize_t length = -1;  ///< any, where negative
};

/// The entries of what has a length; nothing of what has none, since it might never end. Throws
/// Unusable, in one line that begins with the name, for more entries than its length.
std::optional<py::list> listed(const py::handle& given, const std::string& name);

/// The array in `given`: of numbers of that kind and of these axes, in C order. Nothing is copied
/// where it is so already and `dtype` is its type. Throws Unusable, in one line that begins with
/// the name, for anything else; what is not finite is not looked for.
py::array checked_array(const py::handle& given, const std::string& name, Numbers kind,
                        const py::dtype& dtype, const std::vector<Axis>& axes);

/// The same as an array of T.
template <class T>
py::array_t<T, py::array::c_style> array_of(const py::handle& given, const std::string& name,
                                            Numbers kind, const std::vector<Axis>& axes) {
  return checked_array(given, name, kind, py::dtype::of<T>(), axes);
}

/// The vector's memory as an array of that shape, which owns it from now on.
template <class T, class Element>
py::array_t<T> taken(std::vector<Element>&& values, std::vector<py::ssize_t> shape) {
  static_assert(sizeof(Element) % sizeof(T) == 0);
  // An array without entries can have any lengths, and pybind11 multiplies them.
  py::ssize_t bytes = sizeof(T);
  for (const py::ssize_t length : shape)
    if (__builtin_mul_overflow(bytes, std::max<py::ssize_t>(length, 1), &bytes))
      throw Unusable("answers", "an array of these lengths is too large");
  auto owned = std::make_unique<std::vector<Element>>(std::move(values));
  // NumPy wants an address, also of nothing.
  static T nothing{};
  T* data = owned->empty() ? &nothing : reinterpret_cast<T*>(owned->data());
  py::capsule base(owned.get(), [](void* p) { delete static_cast<std::vector<Element>*>(p); });
  owned.release();
  return py::array_t<T>(std::move(shape), data, base);
}

/// (k, N), one row for each element.
template <class T, std::size_t N>
py::array_t<T> taken_rows(std::vector<std::array<T, N>>&& rows) {
  const auto count = static_cast<py::ssize_t>(rows.size());
  return taken<T>(std::move(rows), {count, static_cast<py::ssize_t>(N)});
}

}  // namespace bvlab
