// SPDX-License-Identifier: BSD-3-Clause
/// A separation list that is rebuilt in every k-th run. The example of
/// traversal/adding_a_strategy.md; it is compiled and keeps all laws, but is not in the list.
#pragma once

#include <string_view>

#include "traversal/front.hpp"

namespace bvlab {

class Periodic {
 public:
  static constexpr std::string_view name = "periodic";
  static constexpr std::string_view description =
      "separation list, rebuilt every k runs (periodic:k)";

  explicit Periodic(unsigned k = 6) : period_(k) {}

  template <class Pair>
  void run(const Pair& pair) {
    if (front_.empty() || ++age_ >= period_) front_.restart(), age_ = 0;
    pair.from_front(front_);
  }
  const Front& front() const { return front_; }
  std::size_t front_size() const { return front_.size(); }

 private:
  Front front_;
  unsigned period_, age_ = 0;
};

}  // namespace bvlab
