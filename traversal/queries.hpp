// SPDX-License-Identifier: BSD-3-Clause
/// THE list of queries. What a query has to offer stands in traverse.hpp.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/queries/distance.hpp"
#include "traversal/queries/touching.hpp"

namespace bvlab {

using Queries = TypeList<Touching, Contacts, Distance>;

}  // namespace bvlab
