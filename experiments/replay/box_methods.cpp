// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/box_methods.hpp"

#include <type_traits>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {

template <class T>
std::unique_ptr<AnyMethod<T>> make_method(std::string_view name, const MethodSettings& settings) {
  for (const MethodEntry* entry : method_entries()) {
    if (entry->name != name) continue;
    if constexpr (std::is_same_v<T, float>)
      return entry->narrow(settings);
    else
      return entry->wide(settings);
  }
  throw Unusable("--method " + std::string(name) +
                 ": unknown; available: " + joined(method_entries(), &MethodEntry::name));
}
template std::unique_ptr<AnyMethod<float>> make_method(std::string_view, const MethodSettings&);
template std::unique_ptr<AnyMethod<double>> make_method(std::string_view, const MethodSettings&);

}  // namespace bvlab
