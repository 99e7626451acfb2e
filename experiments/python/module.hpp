// SPDX-License-Identifier: BSD-3-Clause
/// The parts of the Python module; each adds itself.
#pragma once

#include <pybind11/pybind11.h>

namespace bvlab {

void add_meshes(pybind11::module_& module);
void add_replaying(pybind11::module_& module);
void add_world(pybind11::module_& module);
void add_running(pybind11::module_& module);

}  // namespace bvlab
