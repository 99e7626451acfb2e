// SPDX-License-Identifier: BSD-3-Clause
/// run: an experiment or a study into a record, as `bvlab run`.
#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "experiments/python/module.hpp"
#include "experiments/python/signals.hpp"
#include "experiments/python/variants.hpp"
#include "experiments/studies/run_text.hpp"
#include "experiments/studies/side_by_side.hpp"

namespace bvlab {
namespace {

namespace py = pybind11;

std::filesystem::path run(const std::string& text, const std::string& file,
                          const std::string& record, bool counts, int threads,
                          const py::object& progress) {
  if (threads != 0) check_threads(threads);
  RunRequest request{text, file, record, "", {}, {}};
  request.options.threads = threads > 0 ? static_cast<std::size_t>(threads) : cores_allowed();
  if (counts) request.options.measured = Measured::counts;
  // Called on any thread; what Python raises there ends the run, and is raised here.
  const auto tell = [&](std::size_t done, std::size_t all) {
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(done, all);
  };
  request.waiting = [] {
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  };
  return released([&] { return run_text(std::move(request), tell); });
}

}  // namespace

void add_running(py::module_& module) {
  module.def("run_text", &run, py::arg("text"), py::arg("file"), py::arg("record"),
             py::arg("counts"), py::arg("threads"), py::arg("progress"));
}

}  // namespace bvlab
