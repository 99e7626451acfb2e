// SPDX-License-Identifier: BSD-3-Clause
/// The front of two wide trees: every step of the traversal that found the bodies apart, with the
/// lanes that were opened and a deadline, until which the other lanes stay apart; and every
/// triangle that was tested against a leaf, until when it stays apart from it.
///
/// Law: every pair of triangles lies below a lane that is not opened of exactly one entry, or is in
/// one of triangles.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "traversal/front.hpp"

namespace bvlab {

class WideFront {
 public:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  static constexpr double passed = -std::numeric_limits<double>::infinity();

  struct Entry {
    NodePair pair;          ///< of nodes; or a triangle of a with a leaf of b
    std::uint16_t opened;   ///< lanes
    std::uint8_t triangle;  ///< 0 or 1
    std::uint8_t rest;      ///< how many times its gap is not to be measured
  };

  std::size_t size() const { return entries_.size(); }
  bool is_complete() const { return complete_at_ > 0; }
  void clear() { entries_.clear(), deadlines_.clear(), complete_at_ = 0; }
  void complete() { complete_at_ = entries_.size(); }
  /// So much longer than when it was complete that it is to be made anew.
  bool overgrown() const { return entries_.size() > 2 * complete_at_ + 16; }

  void add(const Entry& entry, double deadline) {
    entries_.push_back(entry), deadlines_.push_back(deadline);
  }
  Entry& operator[](std::size_t i) { return entries_[i]; }
  double& deadline(std::size_t i) { return deadlines_[i]; }
  double earliest() const {
    double earliest = std::numeric_limits<double>::infinity();
    for (const double each : deadlines_) earliest = each < earliest ? each : earliest;
    return earliest;
  }

 private:
  std::vector<Entry> entries_;
  std::vector<double> deadlines_;
  std::size_t complete_at_ = 0;
};

}  // namespace bvlab
