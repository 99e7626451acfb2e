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
  /// The same where it is known which boxes moved; a method that cannot be told finds out.
  virtual std::span<const Pair> update(Boxes<T> boxes, std::span<const std::uint32_t> moved) = 0;
  /// Pairs that began and ended; none where the method was not told to report them, or cannot.
  virtual PairChanges changes() const = 0;
  /// Why it does what it does, where the method has a choice; empty elsewhere.
  virtual std::string reason() const = 0;
};

/// A method of the list as the program sees it while it runs.
struct MethodEntry {
  std::string_view name, description;
  std::unique_ptr<AnyMethod<float>> (*narrow)(const MethodSettings&);
  std::unique_ptr<AnyMethod<double>> (*wide)(const MethodSettings&);
};

/// In the order of the list; generated.
std::span<const MethodEntry* const> method_entries();

/// The method of that name for closed boxes; throws Unusable, naming those there are.
template <class T>
std::unique_ptr<AnyMethod<T>> make_method(std::string_view name, const MethodSettings& settings);

}  // namespace bvlab
