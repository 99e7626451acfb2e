// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/box_methods.hpp"

#include <type_traits>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/method_names.hpp"

namespace bvlab {

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodEntry* entry : method_entries()) names.emplace_back(entry->name);
  return names;
}

template <class T>
std::unique_ptr<AnyMethod<T>> make_method(std::string_view name, const MethodSettings& settings) {
  std::string names;
  for (const MethodEntry* entry : method_entries()) {
    if (entry->name == name) {
      if constexpr (std::is_same_v<T, float>)
        return entry->narrow(settings);
      else
        return entry->wide(settings);
    }
    names += (names.empty() ? "" : ", ") + std::string(entry->name);
  }
  throw Unusable("--method " + std::string(name) + ": unknown; available: " + names);
}
template std::unique_ptr<AnyMethod<float>> make_method(std::string_view, const MethodSettings&);
template std::unique_ptr<AnyMethod<double>> make_method(std::string_view, const MethodSettings&);

}  // namespace bvlab
