// SPDX-License-Identifier: BSD-3-Clause
/// The hunt for a false "disjoint" of slab boxes, which are no volume of binary trees.
#include "hierarchies/wide/slab_box_sibling_test.hpp"
#include "tests/stress/volume_hunt.hpp"

namespace bvlab {
namespace {

TEST(VolumeHunt, slab_box) { hunt<SlabBox<float>>(); }

}  // namespace
}  // namespace bvlab
