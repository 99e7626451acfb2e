// SPDX-License-Identifier: BSD-3-Clause
/// What a traversal of two wide trees measures for a memory of margins (wide_margins.hpp): a lower
/// bound on the distance of the bodies, while it finds them apart; and which triangles cross.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>

#include "traversal/wide/wide_front.hpp"

namespace bvlab {

/// Triangles that share a point, by their indices in their meshes.
struct Crossing {
  std::uint32_t a, b;
  bool certain;  ///< the filter in float decided it; otherwise the query's own test did
};

template <Batched S>
class GapMeasure {
 public:
  static constexpr bool measures = true;

  /// Starts a traversal. A front that is not complete is cleared, to be written anew. `rotation`
  /// bounds the rotation of both bodies since the first frame.
  void begin(WideFront* front, double rotation) {
    front_ = front, rotation_ = rotation;
    sweeps_ = front && front->is_complete(), swept_ = false, due_ = 0;
    if (front && !sweeps_) front->clear();
    least_ = S(infinity), least_remaining_ = WideFront::S(infinity);
    touched_.reset(), crossing_.reset();
  }

  /// Whether the traversal starts from a front, and whether that has been swept.
  bool sweeps() const { return sweeps_; }
  bool swept() const { return swept_; }
  WideFront& sweep() { return swept_ = true, *front_; }
  bool front() const { return front_; }
  std::size_t due() const { return due_; }

  /// Which of the entries from `first` on, at most a register of them, are due, that is, may have
  /// closed their gaps.
  [[gnu::always_inline]] std::uint64_t due(std::size_t first, std::size_t entries,
                                           const CornerTransform& corners) {
    const WideFront::S remaining = front_->remaining_gaps(first, corners, rotation_);
    const std::size_t lanes = std::min<std::size_t>(entries, WideFront::width);
    const auto apart = remaining > WideFront::S(0.0f);
    stdx::where(apart, least_remaining_) = stdx::min(least_remaining_, remaining);
    const std::uint64_t due = ~bits(apart) & ((std::uint64_t{1} << lanes) - 1);
    due_ += static_cast<std::size_t>(std::popcount(due));
    return due;
  }

  /// Which volumes of one register of a step are apart. The least gap of those is kept in `least`,
  /// lane by lane. Lanes without a child repeat one.
  [[gnu::always_inline]] static std::uint64_t apart(const S& separation, S& least) {
    const auto apart = separation > S(0.0f);
    stdx::where(apart, least) = stdx::min(least, separation);
    return bits(apart);
  }
  /// Records a step: the lanes that are not apart, and the gap `least` of the others, measured at
  /// `sphere_of()`. Returns those lanes that were not opened before.
  template <class SphereOf>
  [[gnu::always_inline]] std::uint64_t record_step(const NodePair& pair, std::uint64_t lanes,
                                                   std::size_t entry, const S& least,
                                                   SphereOf&& sphere_of) {
    least_ = stdx::min(least_, least);
    if (!front_) return lanes;
    std::uint64_t fresh = lanes;
    if (entry == WideFront::none) {
      entry = front_->add({pair, static_cast<std::uint16_t>(lanes), 0, 0});
    } else {
      auto& opened = (*front_)[entry].opened;
      fresh = lanes & ~std::uint64_t{opened};
      opened = static_cast<std::uint16_t>(opened | fresh);
    }
    front_->set_gap(entry, stdx::hmin(least), sphere_of(), rotation_);
    return fresh;
  }
  /// Records a test of triangles; `touching`: some may touch. Returns whether to measure their gap.
  bool triangles(const NodePair& pair, bool touching, std::size_t entry) {
    if (touching) touched_ = pair;
    if (!front_ || entry == WideFront::none) {
      least_ = S(0.0f);
      if (front_) front_->add({pair, 0, 1, 0});
      return false;
    }
    auto& rest = (*front_)[entry].rest;
    if (rest > 0) --rest;
    if (!touching && rest == 0) return true;
    least_ = S(0.0f);
    return false;
  }
  void crossing(const Crossing& found) { crossing_ = found; }
  const std::optional<Crossing>& crossing() const { return crossing_; }
  void set_triangle_gap(float gap, std::size_t entry, const ReferenceSphere& reference) {
    least_ = stdx::min(least_, S(gap));
    front_->set_gap(entry, gap, reference, rotation_);
    if (!(gap > 0)) (*front_)[entry].rest = 8;
  }

  /// The pair whose triangles touched, or may have.
  const std::optional<NodePair>& touched() const { return touched_; }
  /// A lower bound on the distance of the bodies; 0 where none is known. It covers the rounding of
  /// separations (see slab_box_sibling_test.hpp, gaps).
  double gap() const {
    const double least = std::min(stdx::hmin(least_), stdx::hmin(least_remaining_));
    return least > 0 ? least * (1 - 32 * unit_roundoff<float>) : 0;
  }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();

  S least_;
  WideFront::S least_remaining_;
  std::optional<NodePair> touched_;
  std::optional<Crossing> crossing_;
  WideFront* front_ = nullptr;
  double rotation_ = 0;
  std::size_t due_ = 0;
  bool sweeps_ = false, swept_ = false;
};

}  // namespace bvlab
