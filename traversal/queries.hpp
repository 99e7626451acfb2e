// SPDX-License-Identifier: BSD-3-Clause
/// THE list of queries. The members of a query are listed in queries/query.hpp.
#pragma once

#include "hierarchies/geometry/type_list.hpp"
#include "traversal/queries/contacts.hpp"
#include "traversal/queries/distance.hpp"
#include "traversal/queries/touching.hpp"

namespace bvlab {

using Queries = TypeList<Touching, Contacts, Distance>;

}  // namespace bvlab
