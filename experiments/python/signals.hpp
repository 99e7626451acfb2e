// SPDX-License-Identifier: BSD-3-Clause
/// Ctrl-C while C++ runs: Python's signal handlers are run every so often, and what they raise
/// (KeyboardInterrupt) ends the work.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace bvlab {

/// Thrown where a signal handler has raised; Python's error indicator is set.
struct Interrupted {};

/// To be called often, without the lock of the interpreter: looks about every 20 ms, by a step of
/// calls that adapts, so that it costs next to nothing. Steps stay short, since calls may become
/// slow from one to the next.
class Signals {
 public:
  void operator()() {
    if (++calls_ < next_) return;
    const auto now = std::chrono::steady_clock::now();
    const auto passed = now - last_;
    last_ = now;
    since_ += passed;
    step_ = passed < interval / 8 ? 2 * step_ : passed > interval / 4 ? step_ / 2 : step_;
    step_ = std::clamp<std::size_t>(step_, 1, longest);
    next_ = calls_ + step_;
    if (since_ < interval) return;
    since_ = {};
    const pybind11::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) throw Interrupted();
  }

 private:
  static constexpr std::chrono::milliseconds interval{20};
  static constexpr std::size_t longest = 16;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::duration since_{};  // a handler was last looked for
  std::size_t calls_ = 0, next_ = 1, step_ = 1;
};

/// Calls `work` without the lock of the interpreter; what a signal handler raised is raised.
template <class Work>
auto released(const Work& work) {
  try {
    const pybind11::gil_scoped_release lock;
    return work();
  } catch (const Interrupted&) {
    throw pybind11::error_already_set();
  }
}

}  // namespace bvlab
