// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/runner/box_methods.hpp"

#include "broadphase/broadphase.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

template <class M>
class Named final : public AnyMethod<typename M::Scalar> {
 public:
  explicit Named(const MethodSettings& settings) : method_(settings) {}
  std::span<const Pair> overlapping(Boxes<typename M::Scalar> boxes) override {
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

}  // namespace

template <class T>
std::unique_ptr<AnyMethod<T>> make_method(std::string_view name, const MethodSettings& settings) {
  std::unique_ptr<AnyMethod<T>> method;
  const bool known = Methods<T>::with(name, [&](auto type) {
    method = std::make_unique<Named<typename decltype(type)::type>>(settings);
  });
  if (!known)
    throw Unusable("--method " + std::string(name) + ": unknown; there are " + Methods<T>::names());
  return method;
}
template std::unique_ptr<AnyMethod<float>> make_method(std::string_view, const MethodSettings&);
template std::unique_ptr<AnyMethod<double>> make_method(std::string_view, const MethodSettings&);

std::vector<std::pair<std::string, std::string>> method_descriptions() {
  std::vector<std::pair<std::string, std::string>> all;
  Methods<float>::for_each([&](auto type) {
    using M = typename decltype(type)::type;
    all.emplace_back(M::name, M::description);
  });
  return all;
}

}  // namespace bvlab
