// SPDX-License-Identifier: BSD-3-Clause
/// CGAL's box_self_intersection_d: default cutoff, cutoff 1000 (boxes by value), and two threads.
#define CGAL_LINKED_WITH_TBB
#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/box_intersection_d.h>
#include <tbb/enumerable_thread_specific.h>

#include "broadphase/structures/pair_list.hpp"
#include "experiments/peers/box_peers.hpp"

namespace bvlab {
namespace {

/// A box by value with its index for an id.
struct IndexedBox {
  using NT = float;
  using ID = std::size_t;
  Box<float> box;
  std::uint32_t index = 0;
  static int dimension() { return 3; }
  std::size_t id() const { return index; }
  float min_coord(int axis) const { return box.lo[axis]; }
  float max_coord(int axis) const { return box.hi[axis]; }
};

class Cgal final : public BoxPeer {
 public:
  enum class Run { alone, parallel };
  Cgal(std::ptrdiff_t cutoff, Run run) : cutoff_(cutoff), run_(run) {}

  std::span<const Pair> overlapping(Boxes<float> boxes) override {
    items_.clear();
    pairs_.clear();
    for (std::uint32_t k = 0; k < boxes.size(); ++k) items_.push_back({boxes[k], k});
    if (run_ == Run::alone) {
      CGAL::box_self_intersection_d(
          items_.begin(), items_.end(),
          [this](const IndexedBox& a, const IndexedBox& b) {
            pairs_.push(ordered(a.index, b.index));
          },
          cutoff_);
      return pairs_.view();
    }
    tbb::enumerable_thread_specific<std::vector<Pair>> found;
    CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
        items_.begin(), items_.end(),
        [&](const IndexedBox& a, const IndexedBox& b) {
          found.local().push_back(ordered(a.index, b.index));
        },
        cutoff_);
    for (const auto& some : found) pairs_.append(some);
    return pairs_.view();
  }

 private:
  std::ptrdiff_t cutoff_;
  Run run_;
  std::vector<IndexedBox> items_;
  PairList pairs_;
};

std::unique_ptr<BoxPeer> make(const std::string& name) {
  if (name == "cgal") return std::make_unique<Cgal>(10, Cgal::Run::alone);
  if (name == "cgal-1000") return std::make_unique<Cgal>(1000, Cgal::Run::alone);
  if (name == "cgal-parallel") return std::make_unique<Cgal>(1000, Cgal::Run::parallel);
  return nullptr;
}

}  // namespace

BoxLibrary cgal_boxes() { return {make, {"cgal", "cgal-1000", "cgal-parallel"}}; }

}  // namespace bvlab
