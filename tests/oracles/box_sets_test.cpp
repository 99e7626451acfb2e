// SPDX-License-Identifier: BSD-3-Clause
/// Every method, coherent and not, and the peers that are exact, on the built-in sets for many
/// frames whose motion changes on the way: the same pairs as brute force, every frame.
#include <gtest/gtest.h>

#include "broadphase/broadphase.hpp"
#include "experiments/peers/box_peers.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/scenes/boxes.hpp"
#include "tests/laws/boxes_for_test.hpp"

namespace bvlab {
namespace {

using Frames = std::vector<Frame<float>>;

/// A fifth of the frames each: all drift, nothing moves, a few drift, all move far, some jump.
Frames frames_of(const std::string& set, std::size_t count, int frames) {
  Frames all;
  Frame<float> boxes = make_box_set(set, count, 3);
  const std::pair<const char*, double> motions[] = {
      {"drift", 0.02}, {"still", 0}, {"part", 0.05}, {"breathe", 0.3}, {"teleport", 0}};
  for (const auto& [name, displacement] : motions) {
    BoxMotion motion(name, displacement, set, boxes, 4);
    for (int f = 0; f < frames / 5; ++f, motion.step()) all.push_back(motion.boxes());
    boxes = all.back();
  }
  return all;
}

template <class Method>
void expect_right(Method& method, const Frames& frames, const std::vector<std::vector<Pair>>& right,
                  const std::string& what) {
  for (std::size_t f = 0; f < frames.size(); ++f)
    ASSERT_EQ(sorted(method.overlapping(frames[f])), right[f]) << what << ", frame " << f;
}

/// A peer that finds out what moved, and, where it can be told, one that is.
void check_peer(const std::string& name, const Frames& frames,
                const std::vector<std::vector<Pair>>& right, const std::string& set) {
  expect_right(*make_box_peer(name), frames, right, set + ", " + name);
  const auto told = make_box_peer(name);
  if (!told->takes_moved()) return;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::vector<std::uint32_t> moved;
    for (std::uint32_t k = 0; k < frames[f].size(); ++k)
      if (f == 0 || !(frames[f][k] == frames[f - 1][k])) moved.push_back(k);
    ASSERT_EQ(sorted(told->update(frames[f], moved)), right[f])
        << set << ", " << name << ", told, frame " << f;
  }
}

void check_set(const std::string& set, std::size_t count, int frame_count) {
  const Frames frames = frames_of(set, count, frame_count);
  std::vector<std::vector<Pair>> right;
  for (const auto& frame : frames) right.push_back(pairs_by_definition<Closed>(frame));
  for (const MethodEntry* entry : method_entries())
    for (const Coherence coherence : {Coherence::off, Coherence::on}) {
      MethodSettings settings;
      settings.coherence = coherence;
      expect_right(
          *make_method<float>(entry->name, settings), frames, right,
          set + ", " + std::string(entry->name) + (coherence == Coherence::on ? ", coherent" : ""));
    }
  for (const std::string name :
       {"cgal", "cgal-1000", "fcl-tree", "fcl-ssap", "bullet-dbvt", "embree"})
    check_peer(name, frames, right, set);
  for (const std::string name : {"physx-abp", "physx-pabp", "box3d", "jolt"})
    if (make_box_peer(name)) check_peer(name, frames, right, set);
}

class BoxSet : public ::testing::TestWithParam<std::string> {};
TEST_P(BoxSet, Short) { check_set(GetParam(), 300, 50); }
TEST_P(BoxSet, Long) { check_set(GetParam(), 1500, 400); }
INSTANTIATE_TEST_SUITE_P(Every, BoxSet, ::testing::ValuesIn(box_set_names()), [](const auto& info) {
  std::string name = info.param;
  std::erase(name, '-');
  return name;
});

}  // namespace
}  // namespace bvlab
