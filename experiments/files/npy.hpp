// SPDX-License-Identifier: BSD-3-Clause
/// NumPy's `.npy` files (format versions 1 to 3), C order, little endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "experiments/files/whole_file.hpp"

namespace bvlab {

template <class T>
struct Array {
  std::vector<std::size_t> shape;
  std::vector<T> data;  ///< C order, product of `shape` entries
};

/// Reads an array whose every axis in `shape` that is not `any` must have that length, e.g.
/// {any, any, 7}. Throws Unusable with one line that names the file and what is wrong: missing,
/// truncated, trailing bytes, another type, Fortran order, another shape.
inline constexpr std::size_t any_length = static_cast<std::size_t>(-1);
template <class T>
Array<T> read_npy(const std::filesystem::path& path, std::span<const std::size_t> shape);

/// The same for a file that may hold float32 or float64.
std::variant<Array<float>, Array<double>> read_npy_floating(const std::filesystem::path& path,
                                                            std::span<const std::size_t> shape);

/// The same for a file of whole numbers, uint32 or int64.
Array<std::int64_t> read_npy_whole(const std::filesystem::path& path,
                                   std::span<const std::size_t> shape);

/// The same from bytes in memory; messages name the file by `name`.
template <class T>
Array<T> parse_npy(std::string_view bytes, const std::string& name,
                   std::span<const std::size_t> shape);

/// The header that numpy.save would write for an array of this type and shape.
template <class T>
std::string npy_header(std::span<const std::size_t> shape);

/// Writes the array whole or not at all; `data` holds the product of `shape` entries.
template <class T>
void write_npy(const std::filesystem::path& path, std::span<const std::size_t> shape,
               std::span<const T> data) {
  const std::string header = npy_header<T>(shape);
  const std::string_view parts[] = {
      header, {reinterpret_cast<const char*>(data.data()), data.size_bytes()}};
  write_whole(path, parts);
}

/// The same of rows of N numbers.
template <class T, std::size_t N>
void write_npy_rows(const std::filesystem::path& path, const std::vector<std::array<T, N>>& rows) {
  const std::size_t shape[] = {rows.size(), N};
  write_npy<T>(path, shape, {reinterpret_cast<const T*>(rows.data()), rows.size() * N});
}

/// The same for an array of records; `fields` is their type as NumPy writes it, such as
/// "[('first', '<u4'), ('second', '<f8', (3,))]".
void write_npy_records(const std::filesystem::path& path, const std::string& fields,
                       std::span<const std::size_t> shape, std::span<const std::byte> records);

}  // namespace bvlab
