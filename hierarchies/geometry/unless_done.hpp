// SPDX-License-Identifier: BSD-3-Clause
/// What is to be undone should an exception end the scope, and what is said where there are none
/// (-fno-exceptions, as for WebAssembly): the program ends.
#pragma once

#include <cstdlib>
#include <utility>

namespace bvlab {

/// Calls undo() when it is destroyed, unless it was told that the work is done.
template <class Undo>
class UnlessDone {
 public:
  explicit UnlessDone(Undo undo) : undo_(std::move(undo)) {}
  ~UnlessDone() {
    if (!done_) undo_();
  }
  UnlessDone(const UnlessDone&) = delete;
  UnlessDone& operator=(const UnlessDone&) = delete;
  void is_done() { done_ = true; }

 private:
  Undo undo_;
  bool done_ = false;
};

/// Throws the exception; ends the program where there are none.
template <class Exception>
[[noreturn]] void fail([[maybe_unused]] const Exception& exception) {
#if defined(__cpp_exceptions)
  throw exception;
#else
  std::abort();
#endif
}

}  // namespace bvlab
