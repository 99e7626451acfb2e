// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/pair_arrays.hpp"

#include <optional>
#include <utility>

namespace bvlab {
namespace {

/// The memory is what `dtype` says; py::array_t knows no type for it.
py::array viewed(const py::array& bytes, const char* dtype) {
  const py::object numpy = py::module_::import("numpy");
  const py::object fields = py::module_::import("ast").attr("literal_eval")(dtype);
  return bytes.attr("view")(numpy.attr("dtype")(fields));
}

std::optional<NamedNumbers> numbers(const py::object& given, const char* name,
                                    const std::vector<Axis>& axes) {
  if (given.is_none()) return std::nullopt;
  const auto array = array_of<std::int64_t>(given, name, Numbers::whole, axes);
  return NamedNumbers{name, {array.data(), array.data() + array.size()}};
}

}  // namespace

PairArrays pair_arrays(const py::object& pairs, const py::object& without,
                       const py::object& groups) {
  const std::vector<Axis> rows{{"k"}, {"2", 2}};
  return {numbers(pairs, "pairs", rows), numbers(without, "without", rows),
          numbers(groups, "groups", {{"objects"}})};
}

py::array_t<std::uint32_t> rows_of(std::vector<ObjectPair>&& pairs) {
  static_assert(sizeof(ObjectPair) == 2 * sizeof(std::uint32_t));
  const auto count = static_cast<py::ssize_t>(pairs.size());
  return taken<std::uint32_t>(std::move(pairs), {count, 2});
}

std::shared_ptr<const std::vector<ObjectPair>> chosen_rows(const py::object& rows) {
  const auto array = array_of<std::uint32_t>(rows, "pairs", Numbers::whole, {{"k"}, {"2", 2}});
  const auto* first = reinterpret_cast<const ObjectPair*>(array.data());
  return std::make_shared<const std::vector<ObjectPair>>(first, first + array.shape(0));
}

py::array records_of(std::vector<NearestPair>&& nearest, std::vector<py::ssize_t> shape) {
  const auto bytes = static_cast<py::ssize_t>(nearest.size() * sizeof(NearestPair));
  py::array records = viewed(taken<std::uint8_t>(std::move(nearest), {bytes}),
                             "[('triangles', '<u4', (2,)), ('points', '<f8', (2, 3))]");
  return records.reshape(std::move(shape));
}

}  // namespace bvlab
