// SPDX-License-Identifier: BSD-3-Clause
/// THE lists as GoogleTest takes them.
#pragma once

#include <gtest/gtest.h>

#include "hierarchies/bounding_volume.hpp"
#include "hierarchies/geometry/type_list.hpp"

namespace bvlab {

namespace detail {
template <class List>
struct TypesOf;
template <class... T>
struct TypesOf<TypeList<T...>> {
  using type = ::testing::Types<T...>;
};

template <class List>
struct InBothPrecisions;
template <class... T>
struct InBothPrecisions<TypeList<T...>> {
  using type = ::testing::Types<Over<T, float>..., Over<T, double>...>;
};
}  // namespace detail

template <class List>
using TypesOf = typename detail::TypesOf<List>::type;
/// Every volume over float and over double.
template <class List>
using TypesInBothPrecisions = typename detail::InBothPrecisions<List>::type;

}  // namespace bvlab
