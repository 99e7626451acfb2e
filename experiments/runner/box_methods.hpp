// SPDX-License-Identifier: BSD-3-Clause
/// A broad-phase method chosen by name while the program runs. One virtual call a frame; nothing
/// inside a method is virtual.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "broadphase/settings.hpp"

namespace bvlab {

template <class T>
class AnyMethod {
 public:
  virtual ~AnyMethod() = default;
  virtual std::span<const Pair> overlapping(Boxes<T> boxes) = 0;
  /// Pairs that began and ended; none where the method was not told to report them, or cannot.
  virtual PairChanges changes() const = 0;
  /// Why it does what it does, where the method has a choice; empty elsewhere.
  virtual std::string reason() const = 0;
};

/// The method of that name for closed boxes; throws Unusable, naming those there are.
template <class T>
std::unique_ptr<AnyMethod<T>> make_method(std::string_view name, const MethodSettings& settings);

/// "name  what it is", one entry a method.
std::vector<std::pair<std::string, std::string>> method_descriptions();

}  // namespace bvlab
