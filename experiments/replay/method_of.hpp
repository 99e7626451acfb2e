// SPDX-License-Identifier: BSD-3-Clause
/// All that is compiled for a broad-phase method.
#pragma once

#include "broadphase/broad_phase_method.hpp"
#include "experiments/replay/box_methods.hpp"

namespace bvlab {

namespace detail {

template <class M>
class ChosenMethod final : public AnyMethod<typename M::Scalar> {
 public:
  explicit ChosenMethod(const MethodSettings& settings) : method_(settings) {}
  std::span<const Pair> overlapping(Boxes<typename M::Scalar> boxes) override {
    return method_.overlapping(boxes);
  }
  std::span<const Pair> update(Boxes<typename M::Scalar> boxes,
                               std::span<const std::uint32_t> moved) override {
    if constexpr (TakesMoved<M>)
      return method_.update(boxes, moved);
    else
      return method_.overlapping(boxes);
  }
  PairChanges changes() const override {
    if constexpr (ReportsChanges<M>)
      return method_.changes();
    else
      return {};
  }
  std::string reason() const override {
    if constexpr (requires { method_.reason(); })
      return std::string(method_.reason());
    else
      return {};
  }

 private:
  M method_;
};

template <class M>
std::unique_ptr<AnyMethod<typename M::Scalar>> chosen(const MethodSettings& settings) {
  return std::make_unique<ChosenMethod<M>>(settings);
}

}  // namespace detail

/// Over float boxes and over double ones.
template <BroadPhaseMethod Narrow, BroadPhaseMethod Wide>
constexpr MethodEntry method_of() {
  return {Narrow::name, Narrow::description, detail::chosen<Narrow>, detail::chosen<Wide>};
}

}  // namespace bvlab
