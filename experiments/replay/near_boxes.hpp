// SPDX-License-Identifier: BSD-3-Clause
/// The broad phase of whole scenes, compiled once for all strategies.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "experiments/replay/box_methods.hpp"

namespace bvlab::detail {

class NearBoxes {
 public:
  explicit NearBoxes(const MethodSettings& settings)
      : method_(make_method<float>("auto", settings)) {}
  std::span<const Pair> overlapping(Boxes<float> boxes) { return method_->overlapping(boxes); }
  std::span<const Pair> update(Boxes<float> boxes, std::span<const std::uint32_t> moved) {
    return method_->update(boxes, moved);
  }
  PairChanges changes() const { return method_->changes(); }

 private:
  std::unique_ptr<AnyMethod<float>> method_;
};

}  // namespace bvlab::detail
