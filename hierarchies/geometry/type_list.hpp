// SPDX-License-Identifier: BSD-3-Clause
/// A list of types, each with a `name` and a `description`. THE lists of volumes, strategies and
/// queries are such lists; commands, tests and sweeps iterate over them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace bvlab {

template <class... Types>
struct TypeList {
  static constexpr std::size_t size = sizeof...(Types);
  template <std::size_t I>
  using at = std::tuple_element_t<I, std::tuple<Types...>>;

  /// Calls `visit(std::type_identity<T>{})` for every type, in order.
  template <class Visit>
  static constexpr void for_each(Visit&& visit) {
    (visit(std::type_identity<Types>{}), ...);
  }

  /// Calls `visit` for the type of that name; returns false where there is none.
  template <class Visit>
  static constexpr bool with(std::string_view name, Visit&& visit) {
    return ((Types::name == name && (visit(std::type_identity<Types>{}), true)) || ...);
  }

  /// All names: "a, b, c".
  static std::string names() {
    std::string text;
    for_each([&](auto type) {
      if (!text.empty()) text += ", ";
      text += decltype(type)::type::name;
    });
    return text;
  }
};

}  // namespace bvlab
