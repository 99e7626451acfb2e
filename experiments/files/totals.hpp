// SPDX-License-Identifier: BSD-3-Clause
/// A JSON object of totals, in the order in which they are set. What writes JSON takes long to
/// compile, so only totals.cpp includes it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace bvlab {

class Totals {
 public:
  Totals();
  Totals(Totals&&) noexcept;
  Totals& operator=(Totals&&) noexcept;
  ~Totals();

  /// Numbers, text, or an object of its own; nothing, or an optional without a value (null).
  template <class T>
  Totals& set(const char* key, const T& value) {
    if constexpr (requires { value.has_value(); }) {
      if (value) return set(key, *value);
      set_null(key);
    } else if constexpr (std::is_same_v<T, Totals>)
      set_object(key, value);
    else if constexpr (std::is_same_v<T, std::nullptr_t>)
      set_null(key);
    else if constexpr (std::is_floating_point_v<T>)
      set_number(key, value);
    else if constexpr (std::is_integral_v<T>)
      set_whole(key, static_cast<std::uint64_t>(value));
    else
      set_text(key, value);
    return *this;
  }

  /// Indented, with a line break at its end.
  std::string text() const;

 private:
  void set_object(const char* key, const Totals& value);
  void set_null(const char* key);
  void set_number(const char* key, double value);
  void set_whole(const char* key, std::uint64_t value);
  void set_text(const char* key, std::string_view value);

  struct Object;
  std::unique_ptr<Object> object_;
};

/// To the file, or to standard output where `path` is empty.
void write_totals(const Totals& totals, const std::string& path);

}  // namespace bvlab
