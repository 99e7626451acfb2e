// SPDX-License-Identifier: BSD-3-Clause
/// Replaces CGAL's rational numbers where CGAL is absent.
#include "experiments/files/unusable.hpp"
#include "experiments/peers/triangle_oracle.hpp"

namespace bvlab::oracle {
namespace {
[[noreturn]] void refuse() {
  throw Unusable("the truth in rational numbers: bvlab was built without CGAL");
}
}  // namespace

bool intersect(const Triangle&, const Triangle&) { refuse(); }
bool without_area(const Triangle&) { refuse(); }
long double distance(const Triangle&, const Triangle&) { refuse(); }

}  // namespace bvlab::oracle
